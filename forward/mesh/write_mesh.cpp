#include "forward/mesh/write_mesh.hpp"

#include <exodusII.h>
#include <fmt/format.h>

#include <string>

#include "base/artefact.hpp"
#include "base/errors.hpp"
#include "forward/mesh/file_order.hpp"
#include "forward/mesh/mesh_file.hpp"

namespace calomel {
namespace {

/// A mesh with the nodes of wetted faces shared and the rest numbered without gaps.
struct SharedMesh {
  std::vector<Vec3> nodes;
  std::vector<std::array<NodeId, 8>> elements;
  std::array<std::vector<NodeId>, 3> symmetry;
  std::array<std::vector<std::int32_t>, 2> block;                       ///< elements of steel and mercury
  std::vector<std::pair<const char*, const std::vector<Face>*>> sides;  ///< nodes are those of the mesh itself

  explicit SharedMesh(const Mesh& mesh) : elements(tied_elements(mesh)) {
    std::vector<NodeId> number(mesh.nodes.size(), -1);
    for (const auto& pair : mesh.slip) number[std::size_t(pair.mercury)] = -2;
    for (std::size_t n = 0; n < number.size(); ++n) {
      if (number[n] == -2) continue;
      number[n] = NodeId(nodes.size());
      nodes.push_back(mesh.nodes[n]);
      for (std::size_t k = 0; k < 3; ++k)
        if (mesh.fixed[n] >> k & 1) symmetry[k].push_back(number[n]);
    }
    for (auto& e : elements)
      for (auto& n : e) n = number[std::size_t(n)];
    for (std::size_t e = 0; e < elements.size(); ++e) block[std::size_t(mesh.region[e])].push_back(std::int32_t(e));
    for (const auto& [name, faces] : {std::pair{"outer", &mesh.outer}, {"wetted", &mesh.wetted}, {"rear", &mesh.rear}, {"loaded", &mesh.loaded}})
      if (!faces->empty()) sides.emplace_back(name, faces);
  }
};

constexpr std::array block_names{"steel", "mercury"};
constexpr std::array symmetry_names{"symmetry_x", "symmetry_y", "symmetry_z"};

std::filesystem::path part_of(const std::filesystem::path& path) {
  make_directory(path.parent_path());
  return path.string() + ".part";
}

/// A number in at most 20 characters, which is all that Abaqus and CalculiX read of one: the shortest that reads back the
/// same where that fits, else as many digits as do.
std::string short_number(double x) {
  std::string s = fmt::format("{}", x);
  if (s.size() > 20)
    if (const auto zero = s.find("0."); zero == (s[0] == '-' ? 1u : 0u)) s.erase(zero, 1);
  for (int digits = 17; s.size() > 20; --digits) s = fmt::format("{:.{}g}", x, digits);
  return s;
}

/// An Exodus file that is being written; closed and removed unless committed.
class ExodusFile {
 public:
  explicit ExodusFile(const std::filesystem::path& path) : path_(path), part_(part_of(path)) {
    ex_opts(0);
    int memory = sizeof(double), disk = sizeof(double);
    id_ = ex_create(part_.c_str(), EX_CLOBBER | EX_LARGE_MODEL, &memory, &disk);
    check(id_);
  }
  ~ExodusFile() {
    if (id_ < 0) return;
    ex_close(id_);
    std::error_code ignored;
    std::filesystem::remove(part_, ignored);
  }
  ExodusFile(const ExodusFile&) = delete;
  ExodusFile& operator=(const ExodusFile&) = delete;

  void check(int status) const {
    if (status < 0) throw InputError({.problem = "the mesh cannot be written", .suggestion = "check the path and the free space", .file = part_.string()});
  }
  void commit() {
    const int id = id_;
    id_ = -1;
    check(ex_close(id));
    rename_durably(part_, path_);
  }
  [[nodiscard]] int id() const { return id_; }

 private:
  std::filesystem::path path_, part_;
  int id_ = -1;
};

}  // namespace

void write_abaqus_mesh(const Mesh& mesh, const std::filesystem::path& path) {
  const SharedMesh shared(mesh);
  std::string text = "*HEADING\nnodes in metres; steel and mercury share the nodes of wetted faces\n*NODE\n";
  const auto add = [&]<class... A>(fmt::format_string<A...> form, A&&... values) { text += fmt::format(form, std::forward<A>(values)...); };
  for (std::size_t n = 0; n < shared.nodes.size(); ++n)
    add("{}, {}, {}, {}\n", n + 1, short_number(shared.nodes[n][0]), short_number(shared.nodes[n][1]), short_number(shared.nodes[n][2]));
  for (std::size_t b = 0; b < 2; ++b) {
    if (shared.block[b].empty()) continue;
    add("*ELEMENT, TYPE=C3D8, ELSET={}\n", block_names[b]);
    for (const auto e : shared.block[b]) {
      add("{}", e + 1);
      for (const auto corner : file_order::corner) add(", {}", shared.elements[std::size_t(e)][corner] + 1);
      add("\n");
    }
  }
  for (std::size_t k = 0; k < 3; ++k) {
    if (shared.symmetry[k].empty()) continue;
    add("*NSET, NSET={}\n", symmetry_names[k]);
    for (std::size_t i = 0; i < shared.symmetry[k].size(); ++i)
      add("{}{}", shared.symmetry[k][i] + 1, i % 12 == 11 || i + 1 == shared.symmetry[k].size() ? "\n" : ", ");
  }
  for (const auto& [name, faces] : shared.sides) {
    add("*SURFACE, NAME={}, TYPE=ELEMENT\n", name);
    for (const auto& f : *faces) add("{}, S{}\n", f.element + 1, file_order::abaqus_side[std::size_t(side_of(face_id(mesh.elements, f)))]);
  }
  make_directory(path.parent_path());
  write_atomically(path, text);
}

void write_exodus_mesh(const Mesh& mesh, const std::filesystem::path& path) {
  const SharedMesh shared(mesh);
  ExodusFile file(path);
  const int id = file.id();
  int blocks = 0, node_sets = 0;
  for (const auto& b : shared.block) blocks += !b.empty();
  for (const auto& s : shared.symmetry) node_sets += !s.empty();
  file.check(ex_put_init(id, "calomel", 3, std::int64_t(shared.nodes.size()), std::int64_t(shared.elements.size()), blocks, node_sets,
                         std::int64_t(shared.sides.size())));
  std::array<std::vector<double>, 3> x;
  for (const auto& node : shared.nodes)
    for (std::size_t k = 0; k < 3; ++k) x[k].push_back(node[k]);
  file.check(ex_put_coord(id, x[0].data(), x[1].data(), x[2].data()));
  std::vector<int> position(shared.elements.size());
  int placed = 0;
  for (std::size_t b = 0; b < 2; ++b) {
    const auto& block = shared.block[b];
    if (block.empty()) continue;
    file.check(ex_put_block(id, EX_ELEM_BLOCK, std::int64_t(b) + 1, "HEX8", std::int64_t(block.size()), 8, 0, 0, 0));
    file.check(ex_put_name(id, EX_ELEM_BLOCK, std::int64_t(b) + 1, block_names[b]));
    std::vector<int> connectivity;
    for (const auto e : block) {
      position[std::size_t(e)] = ++placed;
      for (const auto corner : file_order::corner) connectivity.push_back(shared.elements[std::size_t(e)][corner] + 1);
    }
    file.check(ex_put_conn(id, EX_ELEM_BLOCK, std::int64_t(b) + 1, connectivity.data(), nullptr, nullptr));
  }
  for (std::size_t k = 0; k < 3; ++k) {
    std::vector<int> nodes;
    for (const NodeId n : shared.symmetry[k]) nodes.push_back(n + 1);
    if (nodes.empty()) continue;
    file.check(ex_put_set_param(id, EX_NODE_SET, std::int64_t(k) + 1, std::int64_t(nodes.size()), 0));
    file.check(ex_put_set(id, EX_NODE_SET, std::int64_t(k) + 1, nodes.data(), nullptr));
    file.check(ex_put_name(id, EX_NODE_SET, std::int64_t(k) + 1, symmetry_names[k]));
  }
  for (std::size_t s = 0; s < shared.sides.size(); ++s) {
    const auto& [name, faces] = shared.sides[s];
    std::vector<int> elements, sides;
    for (const auto& f : *faces)
      elements.push_back(position[std::size_t(f.element)]), sides.push_back(file_order::exodus_side[std::size_t(side_of(face_id(mesh.elements, f)))]);
    file.check(ex_put_set_param(id, EX_SIDE_SET, std::int64_t(s) + 1, std::int64_t(faces->size()), 0));
    file.check(ex_put_set(id, EX_SIDE_SET, std::int64_t(s) + 1, elements.data(), sides.data()));
    file.check(ex_put_name(id, EX_SIDE_SET, std::int64_t(s) + 1, name));
  }
  file.commit();
}

void write_mesh(const Mesh& mesh, const std::filesystem::path& path) {
  switch (mesh_format(path)) {
    case MeshFormat::abaqus:
      return write_abaqus_mesh(mesh, path);
    case MeshFormat::exodus:
      return write_exodus_mesh(mesh, path);
  }
}

}  // namespace calomel
