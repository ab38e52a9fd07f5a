#pragma once
// Numbers that a figure makes of each of its runs, besides the figures of merit. docs/figures.md lists the kinds.
#include <functional>
#include <string>
#include <vector>

#include "studies/run_data.hpp"
#include "studies/strict_reader.hpp"

namespace hourglass {

/// NaN where the run has no such number: a level never reached, a box without grains.
using Quantity = std::function<double(const RunData&)>;

/// The block of one quantity; what is wrong with it is said to the reader. `below` is the path to it, with its dot.
Quantity quantity_of(const YamlNode& node, const std::string& below, StrictReader& strict);

}  // namespace hourglass
