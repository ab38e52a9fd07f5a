#pragma once
// Names that the writer and the reader of fields.h5 agree on; its layout is told in io/xdmf.hpp.
#include <fmt/format.h>

#include <string>

namespace hourglass {

inline constexpr const char* fields_format = "hourglass fields 1";

/// Of a frame or an outline.
inline std::string member_name(int number) { return fmt::format("{:06}", number); }

}  // namespace hourglass
