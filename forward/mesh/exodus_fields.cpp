#include "forward/mesh/exodus_fields.hpp"

#include <exodusII.h>

#include <algorithm>
#include <utility>

#include "base/artefact.hpp"
#include "base/errors.hpp"
#include "forward/mesh/file_order.hpp"
#include "forward/mesh/topology.hpp"

namespace calomel {
namespace {

/// Which fields a step holds.
std::array<bool, 5> fields_of(const FieldStep& s) {
  return {!s.displacement.empty(), !s.velocity.empty(), !s.pressure.empty(), !s.effective_stress.empty(), !s.time_at_cutoff.empty()};
}

int side_of_face(const Mesh& mesh, const Face& face) { return file_order::exodus_side[std::size_t(side_of(face_id(mesh.elements, face)))]; }

}  // namespace

ExodusFieldWriter::ExodusFieldWriter(std::filesystem::path path, const Mesh& mesh) : path_(std::move(path)), part_(path_.string() + ".part"), mesh_(mesh) {
  make_directory(path_.parent_path());
  ex_opts(0);
  int memory = sizeof(double), file = sizeof(float);
  id_ = ex_create(part_.c_str(), EX_CLOBBER | EX_LARGE_MODEL, &memory, &file);
  if (id_ < 0) throw InputError({.problem = "the fields cannot be written", .suggestion = "check the path and the free space", .file = part_.string()});
  try {
    number_elements();
    write_mesh();
    write_sets();
  } catch (...) {
    ex_close(id_);
    std::error_code ignored;
    std::filesystem::remove(part_, ignored);
    throw;
  }
}

ExodusFieldWriter::ExodusFieldWriter(std::filesystem::path path, const Mesh& mesh, int steps)
    : path_(std::move(path)), part_(path_.string() + ".part"), mesh_(mesh), steps_(steps) {
  ex_opts(0);
  int memory = sizeof(double), file = 0;
  float version = 0;
  id_ = ex_open(part_.c_str(), EX_WRITE, &memory, &file, &version);
  const auto size = [&](ex_inquiry what) { return id_ < 0 ? -1 : ex_inquire_int(id_, what); };
  const char* problem = id_ < 0 ? "the fields of the run so far are gone or broken"
                        : size(EX_INQ_NODES) != std::int64_t(mesh.nodes.size()) || size(EX_INQ_ELEM) != std::int64_t(mesh.elements.size())
                            ? "the fields so far are of another mesh"
                        : size(EX_INQ_TIME) < steps ? "the fields so far end before the checkpoint"
                                                    : nullptr;
  if (problem) {
    if (id_ >= 0) ex_close(id_);
    throw InputError({.problem = problem, .suggestion = "start the run again", .file = part_.string()});
  }
  number_elements();
}

ExodusFieldWriter::~ExodusFieldWriter() {
  if (id_ < 0) return;
  ex_close(id_);
  std::error_code ignored;
  std::filesystem::remove(part_, ignored);
}

void ExodusFieldWriter::check(int status, const char* doing) const {
  if (status < 0)
    throw InputError({.problem = std::string("the fields cannot be written (") + doing + ")", .suggestion = "check the free space", .file = part_.string()});
}

void ExodusFieldWriter::number_elements() {
  position_.resize(mesh_.elements.size());
  for (std::size_t e = 0; e < position_.size(); ++e) block_[std::size_t(mesh_.region[e])].push_back(std::int32_t(e));
  std::int32_t at = 0;
  for (const auto& block : block_)
    for (const auto e : block) position_[std::size_t(e)] = ++at;
}

void ExodusFieldWriter::write_mesh() {
  const std::size_t nodes = mesh_.nodes.size(), elements = mesh_.elements.size();
  int node_sets = 0, side_sets = 0;
  for (int k = 0; k < 3; ++k) node_sets += std::any_of(mesh_.fixed.begin(), mesh_.fixed.end(), [&](auto f) { return f >> k & 1; });
  for (const auto* faces : {&mesh_.outer, &mesh_.wetted, &mesh_.rear, &mesh_.loaded}) side_sets += !faces->empty();
  const int blocks = int(!block_[0].empty()) + int(!block_[1].empty());
  check(ex_put_init(id_, "calomel", 3, std::int64_t(nodes), std::int64_t(elements), blocks, node_sets, side_sets), "header");

  std::array<std::vector<double>, 3> x;
  for (std::size_t k = 0; k < 3; ++k) {
    x[k].resize(nodes);
    for (std::size_t n = 0; n < nodes; ++n) x[k][n] = mesh_.nodes[n][k];
  }
  check(ex_put_coord(id_, x[0].data(), x[1].data(), x[2].data()), "coordinates");
  std::array<char*, 3> axes{const_cast<char*>("x"), const_cast<char*>("y"), const_cast<char*>("z")};
  check(ex_put_coord_names(id_, axes.data()), "names of the coordinates");

  const char* names[] = {"steel", "mercury"};
  for (int b = 0; b < 2; ++b) {
    const auto& block = block_[std::size_t(b)];
    if (block.empty()) continue;
    check(ex_put_block(id_, EX_ELEM_BLOCK, b + 1, "HEX8", std::int64_t(block.size()), 8, 0, 0, 0), "block");
    check(ex_put_name(id_, EX_ELEM_BLOCK, b + 1, names[b]), "name of a block");
    std::vector<int> connectivity;
    connectivity.reserve(8 * block.size());
    for (const auto e : block)
      for (const auto c : file_order::corner) connectivity.push_back(mesh_.elements[std::size_t(e)][c] + 1);
    check(ex_put_conn(id_, EX_ELEM_BLOCK, b + 1, connectivity.data(), nullptr, nullptr), "elements");
  }
}

void ExodusFieldWriter::write_sets() {
  const char* names[] = {"symmetry_x", "symmetry_y", "symmetry_z"};
  for (int k = 0; k < 3; ++k) {
    std::vector<int> nodes;
    for (std::size_t n = 0; n < mesh_.fixed.size(); ++n)
      if (mesh_.fixed[n] >> k & 1) nodes.push_back(int(n) + 1);
    if (nodes.empty()) continue;
    check(ex_put_set_param(id_, EX_NODE_SET, k + 1, std::int64_t(nodes.size()), 0), "node set");
    check(ex_put_set(id_, EX_NODE_SET, k + 1, nodes.data(), nullptr), "node set");
    check(ex_put_name(id_, EX_NODE_SET, k + 1, names[k]), "name of a node set");
  }
  write_side_set(1, "outer", mesh_.outer);
  write_side_set(2, "wetted", mesh_.wetted);
  write_side_set(3, "rear", mesh_.rear);
  write_side_set(4, "loaded", mesh_.loaded);
}

void ExodusFieldWriter::write_side_set(int id, const char* name, const std::vector<Face>& faces) {
  if (faces.empty()) return;
  std::vector<int> elements, sides;
  for (const auto& f : faces) elements.push_back(position_[std::size_t(f.element)]), sides.push_back(side_of_face(mesh_, f));
  check(ex_put_set_param(id_, EX_SIDE_SET, id, std::int64_t(faces.size()), 0), "side set");
  check(ex_put_set(id_, EX_SIDE_SET, id, elements.data(), sides.data()), "side set");
  check(ex_put_name(id_, EX_SIDE_SET, id, name), "name of a side set");
}

void ExodusFieldWriter::define_variables() {
  std::vector<const char*> nodal, element;
  if (written_[0])
    for (const char* name : {"displacement_x", "displacement_y", "displacement_z"}) nodal.push_back(name);
  if (written_[1])
    for (const char* name : {"velocity_x", "velocity_y", "velocity_z"}) nodal.push_back(name);
  if (written_[2]) element.push_back("pressure");
  if (written_[3]) element.push_back("effective_stress");
  if (written_[4]) element.push_back("time_at_cutoff");
  for (const auto& [kind, names] : {std::pair{EX_NODAL, &nodal}, std::pair{EX_ELEM_BLOCK, &element}}) {
    if (names->empty()) continue;
    check(ex_put_variable_param(id_, kind, int(names->size())), "number of fields");
    check(ex_put_variable_names(id_, kind, int(names->size()), const_cast<char**>(names->data())), "names of the fields");
  }
}

void ExodusFieldWriter::write_step(const FieldStep& step) {
  expect(id_ >= 0, "no step is written after commit()");
  if (!begun_) written_ = fields_of(step);
  if (steps_ == 0) define_variables();
  begun_ = true;
  expect(written_ == fields_of(step), "every step of a file has the same fields");
  ++steps_;
  check(ex_put_time(id_, steps_, &step.time), "time");
  int nodal = 0, element = 0;
  std::vector<double> values;
  for (const auto field : {step.displacement, step.velocity}) {
    if (field.empty()) continue;
    expect(field.size() == mesh_.nodes.size(), "a nodal field has a vector per node");
    values.resize(field.size());
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t n = 0; n < field.size(); ++n) values[n] = field[n][k];
      check(ex_put_var(id_, steps_, EX_NODAL, ++nodal, 1, std::int64_t(values.size()), values.data()), "nodal field");
    }
  }
  for (const auto field : {step.pressure, step.effective_stress, step.time_at_cutoff}) {
    if (field.empty()) continue;
    expect(field.size() == mesh_.elements.size(), "an element field has a value per element");
    ++element;
    for (int b = 0; b < 2; ++b) {
      const auto& block = block_[std::size_t(b)];
      if (block.empty()) continue;
      values.resize(block.size());
      for (std::size_t i = 0; i < block.size(); ++i) values[i] = field[std::size_t(block[i])];
      check(ex_put_var(id_, steps_, EX_ELEM_BLOCK, element, b + 1, std::int64_t(values.size()), values.data()), "element field");
    }
  }
  check(ex_update(id_), "flush");
}

void ExodusFieldWriter::flush() {
  check(ex_update(id_), "flush");
  sync_to_disk(part_);
}

void ExodusFieldWriter::close() {
  expect(id_ >= 0, "a file is closed once");
  check(ex_close(std::exchange(id_, -1)), "close");
}

void ExodusFieldWriter::leave() { close(); }

void ExodusFieldWriter::commit() {
  close();
  rename_durably(part_, path_);
}

}  // namespace calomel
