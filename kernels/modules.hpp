#pragma once
// Whether the engine knows the modules that a scene may name under `physics:`. Only perf/bench_modules builds it without,
// to measure that a scene that names none does not pay for them.

namespace hourglass {

#ifdef HOURGLASS_WITHOUT_MODULES
inline constexpr bool with_modules = false;
#else
inline constexpr bool with_modules = true;
#endif

}  // namespace hourglass
