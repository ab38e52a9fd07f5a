// What a child process does must not harm this one.
#include "io/child.hpp"

#include <catch2/catch.hpp>

#include <atomic>
#include <csignal>
#include <stdexcept>

using namespace hourglass;

TEST_CASE("a child sends what it made, also more than a pipe holds") {
  std::string all;
  for (int k = 0; k < 3'000'000; ++k) all += static_cast<char>(k % 251);
  CHECK(from_child([&] { return all; }) == all);
  CHECK(from_child([] { return std::string(); }) == std::string());
}

TEST_CASE("what a child throws is thrown here with its words") {
  CHECK_THROWS_WITH(from_child([]() -> std::string { throw std::out_of_range("nothing at 7"); }),
                    "nothing at 7");
}

TEST_CASE("a child that crashes, writes where it should not or does not end makes nothing") {
  int mine = 1;
  CHECK_FALSE(from_child([&] {
    mine = 2;
    std::raise(SIGSEGV);
    return std::string("reached");
  }));
  CHECK(mine == 1);
  CHECK_FALSE(survives([] { std::raise(SIGABRT); }));
  CHECK_FALSE(from_child(
      [] {
        for (std::atomic<unsigned long> k = 0;; ++k) {
        }
        return std::string();
      },
      1));
  CHECK(survives([] { throw std::runtime_error("not a crash"); }));
}
