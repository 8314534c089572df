#pragma once
/// A mesh in the form that the kernels read, for one precision, one use of the lanes and one kind of element.
#include <cstdint>
#include <vector>

#include "forward/material/linear_elastic.hpp"
#include "forward/solver/aligned_array.hpp"
#include "forward/solver/hexahedron.hpp"
#include "forward/solver/kernel.hpp"

namespace calomel {

/// What the elements of a run are.
enum class ElementKind : std::uint8_t {
  fast,   ///< assumed-strain steel, one-point liquid, small strain
  b_bar,  ///< the steel selectively reduced, the check on the fast one
  finite  ///< fast elements at finite strain
};

/// What every packing of a mesh needs: found once.
struct ElementFacts {
  std::vector<std::uint8_t> parallelepiped;  ///< per mesh element
  std::vector<float> stiffness;              ///< per mesh element, share that is kept: below 1 at re-entrant edges of the steel
  std::vector<float> size;                   ///< per mesh element, shortest edge of liquid ones [m]
};

template <class R>
struct PackedMesh {
  bool runs;
  Layout layout;
  std::vector<Form> form;                                ///< per block
  std::vector<AlignedArray<R>> geometry;                 ///< per block
  std::vector<std::vector<std::uint16_t>> connectivity;  ///< per block, by groups of lanes
  std::vector<AlignedArray<R>> size;                     ///< per block of liquid, by groups of lanes: shortest edge [m]
  std::vector<std::vector<std::int32_t>> elements;       ///< per block, mesh element of every lane slot, -1 = padding

  /// `slow`: elements that take long steps; empty: none.
  PackedMesh(const Mesh& mesh, const LinearElastic& steel, const ElementFacts& facts, ElementKind kind, bool lanes_are_runs, int threads,
             const std::vector<std::uint8_t>& slow = {});

  /// Elements of a group of lanes.
  [[nodiscard]] std::size_t lanes() const { return runs ? 1 : std::size_t(kernels<R>().lanes); }
  /// Numbers in a node's row, and between its components.
  [[nodiscard]] std::size_t width() const { return runs ? 3 * run_lanes : 4; }
  [[nodiscard]] std::size_t stride() const { return runs ? run_lanes : 1; }
};

extern template struct PackedMesh<float>;
extern template struct PackedMesh<double>;

Corners corners_of(const Mesh& mesh, std::size_t element);

}  // namespace calomel
