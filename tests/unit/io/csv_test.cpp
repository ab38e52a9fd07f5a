#include "io/csv.hpp"

#include <catch2/catch.hpp>
#include <fstream>
#include <sstream>

using namespace hourglass;
namespace fs = std::filesystem;

TEST_CASE("csv: what is written is read") {
  const std::vector<std::string> cells{"plain", "", "a, b", "say \"no\"", "two\nlines"};
  CHECK(csv_row(cells) == "plain,,\"a, b\",\"say \"\"no\"\"\",\"two\nlines\"\n");
  CHECK(csv_rows(csv_row(cells) + csv_row({"1", "2"})) ==
        std::vector<std::vector<std::string>>{cells, {"1", "2"}});
  CHECK(csv_rows("a,b\r\n1,2\r\ntorn,ro") == std::vector<std::vector<std::string>>{{"a", "b"}, {"1", "2"}});
  CHECK_THROWS_AS(csv_rows("\"open\n"), std::invalid_argument);
}

TEST_CASE("ledger: goes on where another process was killed") {
  const fs::path path = fs::temp_directory_path() / "ledger.csv";
  fs::remove(path);
  {
    Ledger ledger(path, {"run", "rate"});
    ledger.add({{"run", "a"}, {"rate", "1.5"}});
    ledger.add({{"run", "b, with comma"}});
    CHECK_THROWS_AS(ledger.add({{"run", "a"}}), std::invalid_argument);
    CHECK_THROWS_AS(ledger.add({{"run", "c"}, {"speed", "1"}}), std::invalid_argument);
  }
  std::ofstream(path, std::ios::app) << "c,2.";  // the row it was killed in
  {
    Ledger ledger(path, {"run", "rate"});
    REQUIRE(ledger.rows().size() == 2);
    CHECK(ledger.find("a")->at("rate") == "1.5");
    CHECK(ledger.find("b, with comma"));
    CHECK_FALSE(ledger.find("c"));
    ledger.add({{"run", "c"}, {"rate", "2.5"}});
  }
  std::stringstream text;
  text << std::ifstream(path).rdbuf();
  CHECK(text.str() == "run,rate\na,1.5\n\"b, with comma\",\nc,2.5\n");
  CHECK_THROWS_AS(Ledger(path, {"run", "speed"}), std::invalid_argument);
}
