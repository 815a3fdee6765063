"""The adapter for users of PyVista, beside formulas, oracles and PyVista's own answers."""

import numpy as np
import pytest

from oktett.pyvista import compute_implicit_distance, multi_ray_trace, select_enclosed_points
from oracle import CUBE_FACES, CUBE_VERTICES, ball, crossings, nearest_on_triangles, random_rays

try:
    import pyvista
except ImportError:
    pyvista = None

# Each test for itself: pytest fails where it finds none.
pytestmark = pytest.mark.skipif(pyvista is None, reason="PyVista is not installed")


def surface_of(vertices, faces):
    return pyvista.PolyData(np.asarray(vertices), np.column_stack([np.full(len(faces), 3), faces]).astype(np.int64))


def cube():
    return surface_of(CUBE_VERTICES.astype(float), CUBE_FACES)


def cloud(count, seed, reach=1.6):
    return pyvista.PolyData(np.random.default_rng(seed).uniform(-reach, reach, (count, 3)))


def test_rays_have_the_answers_of_the_oracle():
    vertices, faces = ball(2)
    rays = random_rays(1000, 1.0, seed=1)
    expected, uncertain = crossings(vertices, faces, rays)
    points, index_ray, index_cell = multi_ray_trace(surface_of(vertices, faces), rays[:, :3], rays[:, 3:])
    first = multi_ray_trace(surface_of(vertices, faces), rays[:, :3], rays[:, 3:], first_point=True, retry=True)
    assert points.dtype == np.float64 and index_ray.dtype == index_cell.dtype == np.int64
    assert (np.diff(index_ray) >= 0).all()
    for i in np.nonzero(~uncertain)[0]:
        mine = index_ray == i
        assert index_cell[mine].tolist() == [k for _, k, _, _ in expected[i]]
        places = [rays[i, :3] + t * rays[i, 3:].astype(float) for t, _, _, _ in expected[i]]
        assert points[mine] == pytest.approx(np.array(places).reshape(-1, 3), abs=1e-9)
        assert first[0][first[1] == i] == pytest.approx(np.array(places[:1]).reshape(-1, 3), abs=1e-9)
        assert first[2][first[1] == i].tolist() == index_cell[mine][:1].tolist()


def test_rays_through_edges_and_corners_are_counted_once_and_misses_are_empty():
    points, rays, cells = multi_ray_trace(cube(), [[0, 0, 3], [0.5, 0.5, 3], [9, 9, 9]], [[0, 0, -2]] * 3)
    assert points.tolist() == [[0, 0, 1], [0, 0, -1], [0.5, 0.5, 1], [0.5, 0.5, -1]] and rays.tolist() == [0, 0, 1, 1]
    missed = multi_ray_trace(cube(), [[9, 9, 9], [np.nan, 0, 0]], [[0, 0, 1]] * 2, retry=True)
    assert [array.shape for array in missed] == [(0, 3), (0,), (0,)]
    none = multi_ray_trace(cube(), np.zeros((0, 3)), np.zeros((0, 3)))
    assert [array.shape for array in none] == [(0, 3), (0,), (0,)]


def test_other_cells_and_shapes_are_refused():
    from pyvista.core.errors import NotAllTrianglesError

    with pytest.raises(NotAllTrianglesError):
        multi_ray_trace(pyvista.Cylinder(), [[0, 0, 0]], [[0, 0, 1]])
    for origins, directions in (([[0, 0]], [[0, 0, 1]]), ([[0, 0, 0]], [[0, 0, 1]] * 2)):
        with pytest.raises(ValueError, match="expected"):
            multi_ray_trace(cube(), origins, directions)
    for query in (select_enclosed_points, compute_implicit_distance):
        with pytest.raises(TypeError, match="surface: expected a pyvista.PolyData, found UnstructuredGrid"):
            query(cloud(3, 1), cube().cast_to_unstructured_grid())


@pytest.mark.parametrize("shift", [(0, 0, 0), (3e6, -2e6, 1e6)], ids=["near", "far"])
def test_points_in_a_cube_are_those_of_the_formula(shift):
    asked, surface = cloud(5000, 2), cube()
    inside = (np.abs(asked.points) < 1).all(axis=1)
    asked.points, surface.points = asked.points + shift, surface.points + shift
    asked["kept"] = np.arange(5000)
    result = select_enclosed_points(asked, surface)
    assert isinstance(result, pyvista.PolyData) and result is not asked
    assert result.point_data["SelectedPoints"].dtype == np.uint8
    assert np.array_equal(result["SelectedPoints"], inside.astype(np.uint8))
    assert np.array_equal(result["kept"], asked["kept"]) and "SelectedPoints" not in asked.array_names
    other = select_enclosed_points(asked, surface, tolerance=0.0, inside_out=True, progress_bar=True)
    assert np.array_equal(other["SelectedPoints"], (~inside).astype(np.uint8))


def test_all_kinds_of_datasets_are_asked():
    grid = pyvista.ImageData(dimensions=(5, 6, 7), spacing=(0.5, 0.5, 0.5), origin=(-1.2, -1.3, -1.4))
    inside = (np.abs(grid.points) < 1).all(axis=1)
    for dataset in (grid, grid.cast_to_unstructured_grid(), grid.cast_to_structured_grid()):
        found = select_enclosed_points(dataset, cube())
        assert type(found) is type(dataset) and np.array_equal(found["SelectedPoints"] == 1, inside)
        far = compute_implicit_distance(dataset, cube())
        assert type(far) is type(dataset) and np.array_equal(far["implicit_distance"] < 0, inside)
    empty = pyvista.PolyData()
    assert select_enclosed_points(empty, cube())["SelectedPoints"].shape == (0,)
    assert not select_enclosed_points(grid, pyvista.PolyData())["SelectedPoints"].any()


def test_open_surfaces_are_refused_unless_they_are_not_checked():
    holed = surface_of(CUBE_VERTICES.astype(float), CUBE_FACES[1:])
    asked = cloud(2000, 3)
    with pytest.raises(RuntimeError, match="open edges"):
        select_enclosed_points(asked, holed)
    found = select_enclosed_points(asked, holed, check_surface=False)["SelectedPoints"] == 1
    assert (found == (np.abs(asked.points) < 1).all(axis=1)).mean() > 0.95


def test_distances_to_a_cube_are_those_of_the_formula():
    asked = cloud(4000, 4)
    outside = np.linalg.norm(np.maximum(np.abs(asked.points) - 1, 0), axis=1)
    formula = np.where(outside > 0, outside, np.abs(asked.points).max(axis=1) - 1)
    result = compute_implicit_distance(asked, cube())
    assert result is not asked and "implicit_distance" not in asked.array_names
    assert result.point_data["implicit_distance"].dtype == np.float64
    assert result["implicit_distance"] == pytest.approx(formula, abs=1e-7)
    # Polygons are divided; corners that lie at the same place, but are not shared, count as shared.
    apart = surface_of(CUBE_VERTICES[CUBE_FACES].reshape(-1, 3), np.arange(36).reshape(12, 3))
    for surface in (pyvista.Cube(x_length=2, y_length=2, z_length=2), apart):
        assert compute_implicit_distance(asked, surface)["implicit_distance"] == pytest.approx(formula, abs=1e-7)
    assert compute_implicit_distance(asked, cube(), inplace=True) is asked
    assert asked["implicit_distance"] == pytest.approx(formula, abs=1e-7)
    with pytest.raises(ValueError, match="surface: expected faces"):
        compute_implicit_distance(asked, pyvista.PolyData())


def test_signs_are_right_where_edges_and_corners_are_nearest():
    """Points beside the spikes of a star, where a single triangle's normal tells the wrong side."""
    vertices, faces = ball(1)
    spiked = vertices.astype(float).copy()
    spiked[:6] *= 4
    surface = surface_of(spiked, faces)
    asked = cloud(6000, 5, reach=3.0)
    expected, uncertain = crossings(spiked, faces, np.column_stack([asked.points, np.tile([0.31, 0.47, 0.83], (6000, 1))]))
    inside = np.array([len(hits) % 2 == 1 for hits in expected])
    found = compute_implicit_distance(asked, surface)["implicit_distance"]
    best, _ = nearest_on_triangles(spiked, faces, asked.points.astype(float))
    assert np.abs(found) == pytest.approx(best, abs=1e-6)
    sure = ~uncertain & (best > 1e-6)
    assert inside[sure].any() and np.array_equal(found[sure] < 0, inside[sure])


def test_of_an_open_surface_the_normals_tell_the_side():
    plane = pyvista.Plane(i_size=2, j_size=2)
    asked = cloud(3000, 6)
    found = compute_implicit_distance(asked, plane)["implicit_distance"]
    x, y, z = asked.points.T
    away = np.sqrt(np.maximum(np.abs(x) - 1, 0) ** 2 + np.maximum(np.abs(y) - 1, 0) ** 2 + z**2)
    assert found == pytest.approx(np.sign(z) * away, abs=1e-6)


def test_pyvistas_own_answers_are_the_same():
    asked = cloud(3000, 7)
    for surface in (pyvista.Sphere(radius=0.9), pyvista.Cone(resolution=30), pyvista.ParametricTorus().triangulate()):
        theirs = asked.compute_implicit_distance(surface)["implicit_distance"]
        assert compute_implicit_distance(asked, surface)["implicit_distance"] == pytest.approx(theirs, abs=1e-5)
    theirs = asked.select_enclosed_points(pyvista.Sphere(radius=0.9), tolerance=0.0)["SelectedPoints"]
    assert np.array_equal(select_enclosed_points(asked, pyvista.Sphere(radius=0.9))["SelectedPoints"], theirs)


def test_they_work_as_methods(monkeypatch):
    monkeypatch.setattr(pyvista.PolyData, "multi_ray_trace", multi_ray_trace)
    monkeypatch.setattr(pyvista.DataSet, "select_enclosed_points", select_enclosed_points)
    monkeypatch.setattr(pyvista.DataSet, "compute_implicit_distance", compute_implicit_distance)
    assert cube().multi_ray_trace([[0.1, 0.2, 3]], [[0, 0, -1]], first_point=True)[0].tolist() == [[0.1, 0.2, 1]]
    asked = pyvista.PolyData(np.zeros((1, 3)))
    assert asked.select_enclosed_points.__func__ is select_enclosed_points
    assert asked.compute_implicit_distance.__func__ is compute_implicit_distance
    assert asked.select_enclosed_points(cube())["SelectedPoints"].tolist() == [1]
    assert asked.compute_implicit_distance(cube())["implicit_distance"].tolist() == [-1]
