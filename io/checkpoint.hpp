#pragma once
// checkpoint.h5 and checkpoint.previous.h5: the states from which a run goes on bit for bit (docs/output.md).
//
//   /              attributes format, version, build, scene (the resolved scene file), time, step
//   /state         attribute by number or text; dataset by field with its halo, float64; names as in the walks
//
// Behind the HDF5 file stands a checksum of it.
#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "solver/simulation.hpp"

namespace hourglass {

inline constexpr const char* checkpoint_name = "checkpoint.h5";
inline constexpr const char* previous_checkpoint_name = "checkpoint.previous.h5";

/// Keys of a scene that may change where a run goes on.
inline constexpr std::array changeable_keys{"time.end", "time.max_steps", "output.checkpoint_minutes",
                                            "threads"};

/// Stores a state of the scene; the one stored before stays as the previous. On the disk when it returns, and no moment
/// without a whole one. Throws std::runtime_error "<path>: <reason>" if it cannot be written.
void write_checkpoint(const std::filesystem::path& folder, const Scene& scene, double t, long step,
                      const Walk& walk);

inline constexpr std::size_t seal_length = 24;  ///< of the checksum
/// Puts the checksum behind an HDF5 file, as write_checkpoint() does; without one it does not count as a checkpoint.
void seal(const std::filesystem::path& path);

struct Checkpoint {
  std::unique_ptr<Archive> state;
  double t = 0;  ///< [T]
  long step = 0;
};

/// What is to be done so that the run in a folder goes on.
struct Resumption {
  bool done = false;               ///< nothing: the run is at its end
  std::optional<Checkpoint> from;  ///< if not: where it goes on; nullopt: at the start
  std::vector<std::string> words;  ///< what there is to say about it
};

/// Looks into a run folder; touches nothing. A newest checkpoint that is damaged makes way for the previous. Throws
/// std::invalid_argument if the folder holds what no run wrote, a run of another scene (changeable_keys aside) or of another
/// version, or checkpoints all of which are damaged.
Resumption resume(const std::filesystem::path& folder, const Scene& scene);

}  // namespace hourglass
