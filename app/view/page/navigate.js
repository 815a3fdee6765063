"use strict";
// Cameras that move: each function takes a view of the server (from, at, up, fov, height, orthographic) and
// returns the changed part of it.

const add = (a, b, s = 1) => a.map((x, k) => x + s * b[k]);
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const length = (a) => Math.hypot(...a);
const unit = (a) => a.map((x) => x / length(a));

/// `v` turned about the unit vector `axis`.
function turned(v, axis, angle) {
  const c = Math.cos(angle), s = Math.sin(angle), along = dot(axis, v) * (1 - c), side = cross(axis, v);
  return v.map((x, k) => x * c + side[k] * s + axis[k] * along);
}

function axes(view) {
  const forward = unit(add(view.at, view.from, -1)), right = unit(cross(forward, view.up));
  return {forward, right, up: cross(right, forward)};
}

/// Turns about `at`; angles in radians. The camera stays off the poles, where `up` has no meaning.
function orbit(view, sideways, upwards) {
  const up = unit(view.up), arm = add(view.from, view.at, -1);
  const height = Math.asin(Math.max(-1, Math.min(1, dot(unit(arm), up)))), limit = Math.PI / 2 - 0.02;
  const rise = Math.max(-limit, Math.min(limit, height + upwards)) - height;
  const tilted = turned(arm, axes(view).right, -rise);
  return {from: add(view.at, turned(tilted, up, sideways))};
}

/// The height of the picture where `at` is, in lengths of the scene.
function span(view) {
  return view.orthographic ? view.height
    : 2 * length(add(view.at, view.from, -1)) * Math.tan(view.fov * Math.PI / 360);
}

/// Moves by parts of the picture's height.
function pan(view, right, up) {
  const a = axes(view), move = add(a.right.map((x) => x * right * span(view)), a.up, up * span(view));
  return {from: add(view.from, move), at: add(view.at, move)};
}

function zoom(view, factor) {
  if (view.orthographic) return {height: view.height * factor};
  return {from: add(view.at, add(view.from, view.at, -1), factor)};
}

/// Shows a whole ball.
function frameBall(view, center, radius, aspect) {
  const {forward} = axes(view), narrow = Math.min(1, aspect);
  const half = Math.atan(Math.tan(view.fov * Math.PI / 360) * narrow);
  const distance = view.orthographic ? Math.max(length(add(view.at, view.from, -1)), 2 * radius) : radius / Math.sin(half);
  const change = {at: center, from: add(center, forward, -distance)};
  if (view.orthographic) change.height = 2 * radius / narrow;
  return change;
}
