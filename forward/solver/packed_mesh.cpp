#include "forward/solver/packed_mesh.hpp"

#include "base/errors.hpp"
#include "base/parallel.hpp"

namespace calomel {

Corners corners_of(const Mesh& mesh, std::size_t e) {
  Corners x;
  for (int k = 0; k < 8; ++k) x.col(k) = Eigen::Map<const Eigen::Vector3d>(mesh.nodes[std::size_t(mesh.elements[e][std::size_t(k)])].data());
  return x;
}

namespace {

/// Whether pairs of nodes move as one: where lanes are runs of fast elements in plane strain.
PlanePairs pairs_of(const Mesh& mesh, ElementKind kind, bool lanes_are_runs) {
  return lanes_are_runs && kind == ElementKind::fast ? plane_pairs(mesh) : PlanePairs{};
}

Form form_of(const Layout& layout, const Block& block, ElementKind kind) {
  if (layout.pairs) return Form::plane;
  if (kind == ElementKind::finite) return Form::finite;
  if (kind == ElementKind::b_bar && !block.liquid) return Form::dense;
  return block.parallelepiped ? Form::parallelepiped : Form::general;
}

/// The terms of one element in plane strain, as below. `across`: its own axis that runs across.
template <class Put>
void write_plane_terms(const HexGeometry& g, const LinearElastic& steel, bool liquid, double share, int across, Put&& put) {
  // A corner represents two: modes are half of the hexahedron's, forces twice. In powers of two, so that there is no further rounding.
  const int hourglass = 2 - across, axes[2] = {across == 0 ? 1 : 0, across == 2 ? 1 : 2};
  for (const int i : {0, 2}) {
    for (const int axis : axes) put(2 * g.mode_gradient(i, linear_modes[std::size_t(axis)] - 1));
    put(2 * g.mode_gradient(i, hourglass_modes[std::size_t(hourglass)] - 1));
  }
  put(share * g.volume);
  for (const int i : {0, 2}) put(0.5 * g.hourglass(i, hourglass));
  if (liquid) {
    put(4 * liquid_hourglass(g));
    return;
  }
  const HourglassStiffness k = hourglass_stiffness(g, steel);
  const int x = hourglass, z = 6 + hourglass;
  put(4 * share * k.bending(x, x));
  put(4 * share * k.bending(x, z));
  put(4 * share * k.bending(z, z));
}

/// The terms of one element in the order of `BlockData`, each handed to `put`.
template <class Put>
void write_terms(const Corners& corners, const LinearElastic& steel, Form form, bool liquid, double share, int across, Put&& put) {
  const HexGeometry g = hex_geometry(corners);
  if (form == Form::plane) return write_plane_terms(g, steel, liquid, share, across, put);
  if (form == Form::dense) {
    const ModeStiffness k = b_bar_stiffness(corners, steel);
    put(share * g.volume);
    for (int i = 0; i < 21; ++i)
      for (int j = i; j < 21; ++j) put(share * k(i, j));
    return;
  }
  for (int i = 0; i < 3; ++i) {
    if (form == Form::parallelepiped)
      for (const int m : linear_modes) put(g.mode_gradient(i, m - 1));
    else
      for (int m = 1; m < 8; ++m) put(g.mode_gradient(i, m - 1));
  }
  put(share * g.volume);  // the force's volume; masses are kept apart
  if (liquid) put(liquid_hourglass(g));
  if (form != Form::parallelepiped)
    for (int i = 0; i < 3; ++i)
      for (int a = 0; a < 4; ++a) put(g.hourglass(i, a));
  if (liquid) return;
  const HourglassStiffness k = hourglass_stiffness(g, steel);
  for (int i = 0; i < 9; ++i)
    for (int j = i; j < 9; ++j) put(share * k.bending(i, j));
  for (int i = 0; i < 3; ++i)
    for (int j = i; j < 3; ++j) put(share * k.last(i, j));
}

}  // namespace

template <class R>
PackedMesh<R>::PackedMesh(const Mesh& mesh, const LinearElastic& steel, const ElementFacts& facts, ElementKind kind, bool lanes_are_runs, int threads,
                          const std::vector<std::uint8_t>& slow)
    : runs(lanes_are_runs), layout(make_layout(mesh, facts.parallelepiped, lanes_are_runs ? 256 : 2048, slow, pairs_of(mesh, kind, lanes_are_runs))) {
  const std::size_t group_size = lanes(), blocks = layout.blocks.size();
  form.resize(blocks), geometry.resize(blocks), connectivity.resize(blocks), size.resize(blocks), elements.resize(blocks);
  parallel_for(blocks, threads, [&](std::size_t b) {
    const Block& block = layout.blocks[b];
    form[b] = form_of(layout, block, kind);
    const std::size_t terms = std::size_t(geometry_terms(block.liquid, form[b]));
    const std::size_t groups = (block.elements.size() + group_size - 1) / group_size, corners = corner_count(form[b]);
    geometry[b] = AlignedArray<R>(groups * group_size * terms);
    connectivity[b].resize(groups * group_size * corners);
    elements[b].assign(groups * group_size, -1);
    if (block.liquid) size[b] = AlignedArray<R>(groups * group_size);
    for (std::size_t slot = 0; slot < groups * group_size; ++slot) {
      const std::size_t group = slot / group_size, lane = slot % group_size;
      const bool padding = slot >= block.elements.size();
      const std::size_t source = padding ? group * group_size : slot;
      const std::uint8_t across = layout.pairs ? layout.pairs.across[std::size_t(block.elements[source])] : 0;
      for (std::size_t k = 0; k < corners; ++k)
        connectivity[b][(group * corners + k) * group_size + lane] = block.connectivity[source * 8 + (corners == 8 ? k : plane_corners(across)[k])];
      if (padding) continue;  // zero geometry: no force
      const auto element = std::size_t(block.elements[slot]);
      elements[b][slot] = block.elements[slot];
      if (block.liquid) size[b][slot] = R(facts.size[element]);
      std::size_t term = 0;
      write_terms(corners_of(mesh, element), steel, form[b], block.liquid, double(facts.stiffness[element]), across,
                  [&](double value) { geometry[b][(group * terms + term++) * group_size + lane] = R(value); });
      expect(term == terms, "every geometry term of an element is packed");
    }
  });
}

template struct PackedMesh<float>;
template struct PackedMesh<double>;

}  // namespace calomel
