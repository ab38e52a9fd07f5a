#pragma once
// Whether two fields agree to the last bit.
#include <cstring>

namespace hourglass {

template <class Field>
bool same_bits(const Field& a, const Field& b) {
  for (int j = 0; j < a.ny(); ++j)
    if (std::memcmp(a.row(j), b.row(j), sizeof(typename Field::value_type) * a.nx()) != 0) return false;
  return true;
}

}  // namespace hourglass
