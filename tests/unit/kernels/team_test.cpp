#include "kernels/team.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

using namespace hourglass;

TEST_CASE("shares of rows cover every row once, in order, and differ by at most one") {
  for (int n : {0, 1, 2, 5, 64, 1000001})
    for (int size : {1, 2, 3, 7}) {
      int next = 0, least = n, most = 0;
      for (int rank = 0; rank < size; ++rank) {
        const Rows rows = Team(rank, size, nullptr).rows(n);
        CHECK(rows.begin == next);
        next = rows.end;
        least = std::min(least, rows.end - rows.begin);
        most = std::max(most, rows.end - rows.begin);
      }
      CHECK(next == n);
      CHECK(most - least <= 1);
    }
}

TEST_CASE("members see each other's work after a sync, many times over") {
  for (int threads : {1, 2, 3}) {
    std::vector<long> value(threads, 0);
    int members = 0;
    bool ok = true;
    parallel(threads, [&](Team& team) {
      if (team.leads()) members = team.size();
      for (long round = 1; round <= 2000; ++round) {
        value[team.rank()] = round;
        team.sync();
        for (int k = 0; k < team.size(); ++k)
          if (value[k] != round) ok = false;
        team.sync();
      }
    });
    CHECK(ok);
    CHECK((members >= 1 && members <= threads));
  }
}

TEST_CASE("sums do not depend on the number of threads, to the last bit") {
  const int n = 777;
  std::vector<double> sums;
  for (int threads : {1, 2, 3}) {
    RowSums slots(n);
    double sum = 0;
    parallel(threads, [&](Team& team) {
      const Rows rows = team.rows(n);
      for (int j = rows.begin; j < rows.end; ++j) slots[j] = std::sin(1e3 * j) * std::pow(10.0, j % 17);
      team.sync();
      const double mine = slots.sum();
      if (team.leads()) sum = mine;
    });
    sums.push_back(sum);
  }
  CHECK(sums[0] == sums[1]);
  CHECK(sums[0] == sums[2]);
}

TEST_CASE("the maximum of rows keeps a NaN in sight") {
  RowSums slots(5);
  slots[1] = 3;
  slots[4] = 2;
  CHECK(slots.max() == 3);
  slots[2] = std::numeric_limits<double>::quiet_NaN();
  CHECK(std::isnan(slots.max()));
  slots[2] = 0;
  slots[0] = std::numeric_limits<double>::quiet_NaN();
  CHECK(std::isnan(slots.max()));
}
