#include "apps/field_file.hpp"

#include <exodusII.h>

#include <utility>

#include "base/artefact.hpp"

namespace calomel {

namespace {

void check(int status, const std::filesystem::path& path, const char* doing) {
  if (status < 0)
    throw InputError({.problem = std::string("cannot be written (") + doing + ")", .suggestion = "check the free space and the rights", .file = path.string()});
}

/// Exodus counts the corners of a hexahedron round its faces, the mesh by bits.
constexpr std::array<std::size_t, 8> corner{0, 1, 3, 2, 4, 5, 7, 6};

}  // namespace

FieldFile::FieldFile(std::filesystem::path path, const Mesh& mesh) : path_(std::move(path)), part_(path_.string() + ".part"), nodes_(mesh.nodes.size()) {
  std::vector<std::pair<std::string, std::vector<std::size_t>>> regions{{"steel", {}}, {"mercury", {}}};
  for (std::size_t e = 0; e < mesh.elements.size(); ++e) regions[std::size_t(mesh.region[e])].second.push_back(e);
  std::erase_if(regions, [](const auto& r) { return r.second.empty(); });

  int memory = sizeof(double), disk = sizeof(float);
  id_ = ex_create(part_.c_str(), EX_CLOBBER | EX_LARGE_MODEL, &memory, &disk);
  check(id_, part_, "creating");
  try {
    check(ex_put_init(id_, "calomel", 3, std::int64_t(nodes_), std::int64_t(mesh.elements.size()), std::int64_t(regions.size()), 0, 0), part_, "sizes");
    std::array<std::vector<double>, 3> x;
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (const auto& node : mesh.nodes) x[axis].push_back(node[axis]);
    check(ex_put_coord(id_, x[0].data(), x[1].data(), x[2].data()), part_, "nodes");
    int block = 0;
    for (auto& [name, elements] : regions) {
      ++block;
      check(ex_put_block(id_, EX_ELEM_BLOCK, block, "HEX8", std::int64_t(elements.size()), 8, 0, 0, 0), part_, "blocks");
      check(ex_put_name(id_, EX_ELEM_BLOCK, block, name.c_str()), part_, "blocks");
      std::vector<int> nodes;
      for (const auto e : elements)
        for (const auto c : corner) nodes.push_back(mesh.elements[e][c] + 1);
      check(ex_put_conn(id_, EX_ELEM_BLOCK, block, nodes.data(), nullptr, nullptr), part_, "elements");
      blocks_.push_back(std::move(elements));
    }
    char nodal[6][16] = {"displacement_x", "displacement_y", "displacement_z", "velocity_x", "velocity_y", "velocity_z"};
    char element[2][20] = {"pressure", "effective_stress"};
    char* nodal_names[6];
    char* element_names[2];
    for (int i = 0; i < 6; ++i) nodal_names[i] = nodal[i];
    for (int i = 0; i < 2; ++i) element_names[i] = element[i];
    check(ex_put_variable_param(id_, EX_NODAL, 6), part_, "variables");
    check(ex_put_variable_names(id_, EX_NODAL, 6, nodal_names), part_, "variables");
    check(ex_put_variable_param(id_, EX_ELEM_BLOCK, 2), part_, "variables");
    check(ex_put_variable_names(id_, EX_ELEM_BLOCK, 2, element_names), part_, "variables");
  } catch (...) {
    ex_close(id_);
    throw;
  }
}

FieldFile::~FieldFile() {
  if (id_ < 0) return;
  ex_close(id_);
  std::error_code ignored;
  std::filesystem::remove(part_, ignored);
}

void FieldFile::write(const FieldSnapshot& snapshot) {
  ++steps_;
  check(ex_put_time(id_, steps_, &snapshot.time), part_, "time");
  std::vector<double> values(nodes_);
  int variable = 0;
  for (const auto* field : {&snapshot.displacement, &snapshot.velocity})
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (std::size_t n = 0; n < nodes_; ++n) values[n] = (*field)[n][axis];
      check(ex_put_var(id_, steps_, EX_NODAL, ++variable, 1, std::int64_t(nodes_), values.data()), part_, "nodal fields");
    }
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    variable = 0;
    for (const auto* field : {&snapshot.pressure, &snapshot.effective_stress}) {
      values.clear();
      for (const auto e : blocks_[b]) values.push_back((*field)[e]);
      check(ex_put_var(id_, steps_, EX_ELEM_BLOCK, ++variable, std::int64_t(b + 1), std::int64_t(values.size()), values.data()), part_, "element fields");
    }
    values.resize(nodes_);
  }
}

void FieldFile::commit() {
  const int id = std::exchange(id_, -1);
  check(ex_close(id), part_, "closing");
  rename_durably(part_, path_);
}

}  // namespace calomel
