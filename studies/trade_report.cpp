// What a trade writes: tables and pictures.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "io/chart.hpp"
#include "io/csv.hpp"
#include "io/files.hpp"
#include "io/provenance.hpp"
#include "studies/pareto.hpp"
#include "studies/trade.hpp"

namespace hourglass {
namespace fs = std::filesystem;
namespace {

bool is_mass_defect(const Quantity& q) { return q.key == std::string("mass_defect"); }

/// An error for people: in per cent, but for the mass defect.
std::string percent(const Quantity& q, double error) {
  if (!std::isfinite(error)) return "–";
  if (is_mass_defect(q)) return fmt::format("{:.1e}", error);
  return error < 1 ? fmt::format("{:.2g} %", 100 * error) : fmt::format("{:.0f} %", 100 * error);
}

/// Quantities that the reference has.
std::vector<Quantity> measured(const TradeResult& result) {
  std::vector<Quantity> out;
  for (const auto& row : result.reference) out.push_back(row.quantity);
  return out;
}

using Row = TradeResult::Row;

void write_levers(const TradeResult& result, const fs::path& path) {
  const std::vector<Quantity> known = measured(result);
  std::vector<std::string> cells{"run",    "group",       "lever",        "changes_model", "cells_x",
                                 "status", "cpu_seconds", "wall_seconds", "time_ratio"};
  for (const Quantity& q : known) cells.push_back(fmt::format("error_{}", q.key));
  for (const Quantity& q : known) cells.push_back(fmt::format("change_{}", q.key));
  cells.insert(cells.end(), {"noise", "name"});
  std::string text = csv_row(cells);
  for (std::size_t k = 0; k < result.rows.size(); ++k) {
    const Row& row = result.rows[k];
    const TradeOutcome& o = row.outcome;
    cells = {row.run.name,
             row.run.group,
             row.run.variant.lever,
             row.run.variant.model ? "1" : "0",
             fmt::format("{}", row.cells_across()),
             name_of(o.status),
             fmt::format("{:.6g}", o.cpu_seconds),
             fmt::format("{:.6g}", o.wall_seconds),
             fmt::format("{:.6g}", result.time_ratio(row))};
    const auto numbers = [&](const Record& record) {
      for (const Quantity& q : known) {
        const double number = TradeResult::number(record, q);
        cells.push_back(std::isfinite(number) ? fmt::format("{:.6g}", number) : "");
      }
    };
    numbers(row.error);
    numbers(row.change);
    std::vector<std::string> noise, names;
    for (const Quantity& q : known)
      if (k > 0 && result.is_noise(row, q)) noise.emplace_back(q.key);
    if (result.fast == k) names.emplace_back("fast");
    if (result.middle == k) names.emplace_back("balanced");
    if (result.accurate == k) names.emplace_back("accurate");
    cells.push_back(fmt::format("{}", fmt::join(noise, " ")));
    cells.push_back(fmt::format("{}", fmt::join(names, " ")));
    text += csv_row(cells);
  }
  write_atomically(path, text);
}

void draw_pareto(const TradeResult& result, const TradeResult::ReferenceRow& reference,
                 const fs::path& path) {
  const Quantity& q = reference.quantity;
  Chart chart{.title = fmt::format("{}: {}", result.balanced.name, q.title),
              .x = {"time [processor seconds]", true},
              .y = {fmt::format("error [{}]", q.error), true}};
  std::vector<CostAndError> points;
  for (const Row& row : result.rows)
    points.push_back({result.seconds(row),
                      row.run.variant.model || row.failed() ? NAN : TradeResult::number(row.error, q)});
  const std::vector<std::size_t> front = pareto_front(points);
  Series dominated{.name = "dominated", .line = false, .mark = Mark::disc, .greyed = true},
      model{.name = "changes the model", .line = false, .mark = Mark::ring, .greyed = true},
      best{.name = "Pareto front, cells across", .mark = Mark::disc},
      named{.name = "named settings", .line = false, .mark = Mark::diamond, .colour = 1},
      start{.name = "balanced as it stands", .line = false, .mark = Mark::square, .colour = 2};
  const auto add = [&](Series& s, std::size_t k, const std::string& label) {
    s.x.push_back(result.seconds(result.rows[k]));
    s.y.push_back(TradeResult::number(result.rows[k].error, q));
    s.labels.push_back(label);
  };
  for (std::size_t k = 0; k < result.rows.size(); ++k) {
    if (result.rows[k].failed()) continue;
    if (result.rows[k].run.variant.model)
      add(model, k, "");
    else if (std::find(front.begin(), front.end(), k) == front.end())
      add(dominated, k, "");
  }
  std::vector<int> labelled;  // the cheapest of each grid
  for (const std::size_t k : front) {
    const int cells = result.rows[k].cells_across();
    const bool first = std::find(labelled.begin(), labelled.end(), cells) == labelled.end();
    if (first) labelled.push_back(cells);
    add(best, k, first ? fmt::format("{}", cells) : "");
  }
  add(start, 0, "");
  if (result.fast) add(named, *result.fast, "fast");
  if (result.middle) add(named, *result.middle, "balanced");
  if (result.accurate) add(named, *result.accurate, "accurate");
  for (const Series& s : {dominated, model, best, start, named})
    if (!s.x.empty()) chart.series.push_back(s);
  if (reference.found.error_bar > 0)
    chart.lines.push_back({ReferenceLine::Way::horizontal, reference.found.error_bar, "reference ±"});
  draw_chart(chart, path);
}

std::string reference_text(const TradeResult& result) {
  if (result.reference_cells.size() != 3) return {};
  const auto& n = result.reference_cells;
  std::string out = fmt::format(
      "## Reference\n\nThe same scene with tight tolerances in double precision on {}, {} and {} cells "
      "across, the step "
      "shrinking as the\ncells do, extrapolated at the observed order. Errors are against this.\n\n| "
      "quantity | error is | "
      "error at {} | {} | {} | order | error bar of the reference |\n|---|---|---|---|---|---|---|\n",
      n[0], n[1], n[2], n[0], n[1], n[2]);
  for (const auto& r : result.reference) {
    if (is_mass_defect(r.quantity)) continue;
    out += fmt::format("| {} | {} | {} | {} | {} | {} | {}{} |\n", r.quantity.title, r.quantity.error,
                       percent(r.quantity, r.apart[0]), percent(r.quantity, r.apart[1]),
                       percent(r.quantity, r.apart[2]),
                       r.found.order > 0 ? fmt::format("{:.2g}", r.found.order) : "–",
                       percent(r.quantity, r.found.error_bar),
                       r.found.doubt.empty() ? "" : fmt::format(", wide: it {}", r.found.doubt));
  }
  for (const auto& r : result.reference)
    if (r.found.values.size() == 1 && !is_mass_defect(r.quantity))
      out += fmt::format("\nReference {}: **{:.5g} ± {:.2g}**\n", r.quantity.title, r.found.values[0],
                         r.found.error_bar * (r.quantity.relative ? std::abs(r.found.values[0]) : 1));
  return out;
}

std::string table_head(const std::vector<Quantity>& known, const char* first) {
  std::string head = fmt::format("| {} | cells across | processor s | time |", first),
              rule = "|---|---|---|---|";
  for (const Quantity& q : known) {
    head += fmt::format(" {} |", q.title);
    rule += "---|";
  }
  return head + "\n" + rule + "\n";
}

std::string table_row(const TradeResult& result, const Row& row, const std::vector<Quantity>& known,
                      const std::string& name) {
  std::string out = fmt::format("| {} | {} | {:.3g} | {:.2f} |", name, row.cells_across(),
                                result.seconds(row), result.time_ratio(row));
  for (const Quantity& q : known)
    out += row.failed()
               ? fmt::format(" {} |", name_of(row.outcome.status))
               : fmt::format(" {}{} |", &row != &result.rows.front() && result.is_noise(row, q) ? "~ " : "",
                             percent(q, TradeResult::number(row.error, q)));
  return out + "\n";
}

std::string named_text(const TradeResult& result) {
  const std::vector<Quantity> known = measured(result);
  std::string out = "\n## Named settings\n\n" + table_head(known, "setting");
  const auto add = [&](const char* name, std::optional<std::size_t> k, const char* none) {
    if (k)
      out += table_row(result, result.rows[*k], known,
                       fmt::format("**{}**: `{}`", name, result.rows[*k].run.name));
    else
      out += fmt::format("| **{}** | none: {} |\n", name, none);
  };
  add("fast", result.fast, "nothing is 5 times cheaper than balanced");
  add("balanced", result.middle, "no discharge to choose by");
  add("accurate", result.accurate, "no discharge within 0.5 % with a flow no worse than that of balanced");
  return out +
         "\nbalanced: on the front of time and discharge, nearest to an error of 2 %. fast: at least 5 times "
         "cheaper, "
         "with the least error\nof the discharge. accurate: the cheapest with the discharge within 0.5 % and "
         "a velocity "
         "no worse than that of balanced.\n";
}

std::string levers_text(const TradeResult& result) {
  const std::vector<Quantity> known = measured(result);
  std::string out =
      "\n## What each lever costs and buys\n\nErrors against the reference; time over that of balanced.";
  if (!result.spread.empty()) {
    out +=
        " `~`: no further from balanced than\nnoise of 1e-3 sqrt(g d) in the initial velocity carries it "
        "(largest of "
        "the ensemble):";
    for (const Quantity& q : known)
      if (std::isfinite(TradeResult::number(result.spread, q)))
        out += fmt::format(" {} {},", q.title, percent(q, TradeResult::number(result.spread, q)));
    out.back() = '.';
  }
  out += "\n\n" + table_head(known, "setting");
  for (const bool model : {false, true})
    for (const Row& row : result.rows)
      if ((row.run.group == "balanced" || row.run.group == "lever") && row.run.variant.model == model)
        out += table_row(result, row, known,
                         fmt::format("`{}`{}", row.run.name, model ? " (another model)" : ""));
  const auto add = [&](const char* group, const std::string& head) {
    const auto is_of = [&](const Row& row) { return row.run.group == group; };
    if (std::none_of(result.rows.begin(), result.rows.end(), is_of)) return;
    out += head + table_head(known, "setting");
    for (const Row& row : result.rows)
      if (is_of(row)) out += table_row(result, row, known, fmt::format("`{}`", row.run.name));
  };
  add("combination", "\n## Combinations\n\n");
  add("extrapolation",
      "\n## Extrapolated from coarser grids\n\nDischarge rate and quasi-static share by Richardson from runs "
      "above on this "
      "grid and on one or two with half the\ncells of the next, the rest from the finest; the time is that "
      "of all of "
      "them.\n\n");
  return out;
}

}  // namespace

void write_trade(const TradeResult& result, const fs::path& folder) {
  write_levers(result, folder / "levers.csv");
  const Provenance made = provenance();
  const std::string made_with =
      fmt::format("hourglass {}, {}, {} thread(s).", made.version, made.revision, result.balanced.threads);
  std::string text =
      fmt::format("# Speed against accuracy: {}\n\n{} cells across, to t = {:.6g}. {}\n\n",
                  result.balanced.name, result.balanced.cells_x, result.balanced.time.end, made_with);
  text += reference_text(result) + named_text(result) + levers_text(result) + "\n## Pictures\n";
  for (const auto& row : result.reference) {
    const std::string name = fmt::format("pareto_{}.png", row.quantity.key);
    draw_pareto(result, row, folder / name);
    text += fmt::format("\n![{}]({})\n", row.quantity.title, name);
  }
  if (!result.left_out.empty()) {
    text += "\n## Left out\n\n";
    for (const std::string& what : result.left_out) text += "* " + what + "\n";
  }
  write_atomically(folder / "trade.md", text);
}

}  // namespace hourglass
