#!/usr/bin/env bash
# The ninth browser tab waits five seconds for a server made with cpp-httplib, though the other eight are idle.
#
# One would guess: a connection that is kept open without a request costs a server nothing but memory.
# What happens: cpp-httplib 0.11.4 gives each connection a thread until it has been idle for 5 seconds, and its pool has 8 threads on
# machines of up to 9 processors. Eight clients that were answered and keep their connection make the ninth wait for 5 seconds.
# Why a user of a ray tracer meets it: viewers serve a page and tiles of the picture to browsers, which keep up to six connections each.
# Two windows are enough for pauses that look like a slow renderer.
#
# Needs Debian 12, g++, the network and at most 9 processors. Debian 12: libcpp-httplib-dev 0.11.4+ds-1+deb12u1. About 40 seconds.
. "$(dirname "${BASH_SOURCE[0]}")/common.bash"
unpack bookworm amd64 libcpp-httplib-dev=0.11.4+ds-1+deb12u1 libcpp-httplib0.11=0.11.4+ds-1+deb12u1
cd "$work"

cat >clients.cpp <<'CPP'
#include <httplib.h>

#include <chrono>
#include <cstdio>
#include <memory>
#include <vector>

int main() {
  httplib::Server server;
  server.Get("/tile", [](const httplib::Request&, httplib::Response& response) { response.set_content("tile", "text/plain"); });
  const int port = server.bind_to_any_port("127.0.0.1");
  std::thread listening([&] { server.listen_after_bind(); });
  std::vector<std::unique_ptr<httplib::Client>> clients;
  for (int i = 1; i <= 9; ++i) {
    clients.push_back(std::make_unique<httplib::Client>("127.0.0.1", port));
    clients.back()->set_keep_alive(true);
    clients.back()->set_read_timeout(30);
    const auto start = std::chrono::steady_clock::now();
    const auto answer = clients.back()->Get("/tile");
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const bool answered = answer && answer->status == 200;
    if (i >= 8) std::printf("%s, %s\n", answered ? "answered" : "failed", seconds < 2 ? "at once" : "after more than 2 seconds");
  }
  clients.clear();
  server.stop();
  listening.join();
}
CPP
g++ -O1 -std=c++17 -I"$root/usr/include" clients.cpp -o clients -L"$libraries" -lcpp-httplib -Wl,-rpath-link,"$libraries"
run "$work/clients" >out

guess "both clients are answered at once"
seen "client 8" "answered, at once" "$(sed -n 1p out)"
seen "client 9" "answered, after more than 2 seconds" "$(sed -n 2p out)"
finish
