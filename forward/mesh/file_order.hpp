#pragma once
/// How mesh files count the corners and sides of a hexahedron.
#include <array>
#include <cstddef>

namespace calomel::file_order {

/// Our corner at each place of an element in a file: Exodus II (Schoof and Yarberry, SAND92-2137) and Abaqus both run round
/// the bottom and then round the top. The permutation is its own inverse.
inline constexpr std::array<std::size_t, 8> corner{0, 1, 3, 2, 4, 5, 7, 6};
/// Number in the file of our faces -x, +x, -y, +y, -z, +z, counted from 1.
inline constexpr std::array<int, 6> exodus_side{4, 2, 1, 3, 5, 6};
inline constexpr std::array<int, 6> abaqus_side{6, 4, 3, 5, 1, 2};

/// Our face of the side with this number, or -1.
constexpr int face_of(const std::array<int, 6>& sides, int number) {
  for (std::size_t f = 0; f < 6; ++f)
    if (sides[f] == number) return int(f);
  return -1;
}

}  // namespace calomel::file_order
