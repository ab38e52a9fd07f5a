#pragma once
// `hourglass measure`: figures of merit and plots of what is stored already. docs/studies.md says what each is.
#include <filesystem>

namespace hourglass {

/// Of a run: measure.csv, step_change.csv and residence_time.csv if it has tracers, and plots/. Prints the figures. Throws
/// std::invalid_argument if the folder holds no run, std::runtime_error if it cannot be read or written.
void measure_run(const std::filesystem::path& run);

/// Of a sweep, so far: curves.csv, fit.csv if an axis changes the width of orifices, and plots/. Throws as above.
void measure_study(const std::filesystem::path& folder);

/// Either, by what the folder holds.
void measure(const std::filesystem::path& folder);

}  // namespace hourglass
