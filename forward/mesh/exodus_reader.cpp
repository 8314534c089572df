#include <exodusII.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/artefact.hpp"
#include "base/errors.hpp"
#include "forward/mesh/file_order.hpp"
#include "forward/mesh/mesh_file.hpp"

namespace calomel {
namespace {

/// An open Exodus file, numbers as 64 bit integers.
class ExodusReader {
 public:
  explicit ExodusReader(const std::filesystem::path& path) {
    mesh_.path = path;
    if (!std::filesystem::is_regular_file(path)) fail("the file does not exist", "check geometry.file; relative paths start at the case file");
    ex_opts(0);
    int memory = sizeof(double), disk = 0;
    float version = 0;
    id_ = ex_open(path.c_str(), EX_READ | EX_ALL_INT64_API, &memory, &disk, &version);
    if (id_ < 0) fail("this is no Exodus II file that can be read: another format, or truncated", "write it again; Abaqus input ends in .inp");
    int longest = int(ex_inquire_int(id_, EX_INQ_DB_MAX_USED_NAME_LENGTH));
    name_length_ = std::max(longest, 32);
    ex_set_max_name_length(id_, name_length_);
  }
  ~ExodusReader() {
    if (id_ >= 0) ex_close(id_);
  }
  ExodusReader(const ExodusReader&) = delete;
  ExodusReader& operator=(const ExodusReader&) = delete;

  MeshFile read() {
    ex_init_params sizes{};
    check(ex_get_init_ext(id_, &sizes), "its header");
    if (sizes.num_dim != 3) fail(fmt::format("the mesh has {} dimensions", sizes.num_dim), "a target needs three; one layer of elements does for plane strain");
    if (sizes.num_elem <= 0) fail("the file holds no elements", "");
    if (sizes.num_nodes <= 0 || sizes.num_nodes >= std::int64_t(1) << 31 || sizes.num_elem >= std::int64_t(1) << 28)
      fail(fmt::format("the header speaks of {} nodes and {} elements", sizes.num_nodes, sizes.num_elem), "the file is damaged, or too large");
    read_nodes(std::size_t(sizes.num_nodes));
    read_blocks(std::size_t(sizes.num_elem));
    for (const auto id : ids(EX_ELEM_SET, sizes.num_elem_sets)) {
      auto& set = mesh_.element_sets[name(EX_ELEM_SET, id, "element_set")];
      for (const auto e : members(EX_ELEM_SET, id, false).first) set.push_back(element(e, "element set", id));
    }
    for (const auto id : ids(EX_NODE_SET, sizes.num_node_sets)) {
      auto& set = mesh_.node_sets[name(EX_NODE_SET, id, "node_set")];
      for (const auto n : members(EX_NODE_SET, id, false).first) {
        if (n < 1 || n > sizes.num_nodes) fail(fmt::format("node set {} names node {} of {}", id, n, sizes.num_nodes), damaged);
        set.push_back(NodeId(n - 1));
      }
    }
    for (const auto id : ids(EX_SIDE_SET, sizes.num_side_sets)) {
      auto& set = mesh_.side_sets[name(EX_SIDE_SET, id, "side_set")];
      const auto [elements, sides] = members(EX_SIDE_SET, id, true);
      for (std::size_t i = 0; i < elements.size(); ++i) {
        const int face = file_order::face_of(file_order::exodus_side, int(sides[i]));
        if (face < 0) fail(fmt::format("side set {} names side {} of a hexahedron", id, sides[i]), damaged);
        set.push_back(6 * element(elements[i], "side set", id) + face);
      }
    }
    return std::move(mesh_);
  }

 private:
  static constexpr const char* damaged = "the file is damaged or truncated; write it again";

  [[noreturn]] void fail(const std::string& problem, const std::string& suggestion) const {
    throw InputError({.problem = problem, .suggestion = suggestion, .file = mesh_.path.string()});
  }
  void check(int status, const std::string& what) const {
    if (status < 0) fail("cannot be read: " + what, damaged);
  }

  std::vector<std::int64_t> ids(ex_entity_type type, std::int64_t count) const {
    std::vector<std::int64_t> all(static_cast<std::size_t>(count));
    if (count > 0) check(ex_get_ids(id_, type, all.data()), "the numbers of its sets");
    return all;
  }
  std::string name(ex_entity_type type, std::int64_t id, const char* kind) const {
    std::vector<char> text(std::size_t(name_length_) + 1, 0);
    if (ex_get_name(id_, type, id, text.data()) < 0 || !text[0]) return fmt::format("{}_{}", kind, id);
    return lower_case(text.data());
  }
  /// Entries of a set, and its sides.
  std::pair<std::vector<std::int64_t>, std::vector<std::int64_t>> members(ex_entity_type type, std::int64_t id, bool sides) const {
    std::int64_t count = 0, factors = 0;
    check(ex_get_set_param(id_, type, id, &count, &factors), fmt::format("the size of set {}", id));
    std::vector<std::int64_t> entries(static_cast<std::size_t>(count)), extra(sides ? std::size_t(count) : 0);
    if (count > 0) check(ex_get_set(id_, type, id, entries.data(), sides ? extra.data() : nullptr), fmt::format("set {}", id));
    return {std::move(entries), std::move(extra)};
  }
  std::int32_t element(std::int64_t number, const char* kind, std::int64_t id) const {
    if (number < 1 || number > std::int64_t(mesh_.elements.size()))
      fail(fmt::format("{} {} names element {} of {}", kind, id, number, mesh_.elements.size()), damaged);
    return std::int32_t(number - 1);
  }

  void read_nodes(std::size_t count) {
    std::array<std::vector<double>, 3> x;
    for (auto& axis : x) axis.resize(count);
    check(ex_get_coord(id_, x[0].data(), x[1].data(), x[2].data()), "the coordinates");
    mesh_.node_label.resize(count);
    check(ex_get_id_map(id_, EX_NODE_MAP, mesh_.node_label.data()), "the numbers of the nodes");
    mesh_.nodes.resize(count);
    for (std::size_t n = 0; n < count; ++n)
      for (std::size_t k = 0; k < 3; ++k) {
        mesh_.nodes[n][k] = x[k][n];
        if (!std::isfinite(x[k][n])) fail(fmt::format("coordinate {} of node {} is {}", "xyz"[k], mesh_.node_label[n], x[k][n]), "a finite number is expected");
      }
  }

  void read_blocks(std::size_t count) {
    std::vector<std::int64_t> labels(count);
    check(ex_get_id_map(id_, EX_ELEM_MAP, labels.data()), "the numbers of the elements");
    ex_init_params sizes{};
    check(ex_get_init_ext(id_, &sizes), "its header");
    std::vector<std::int64_t> connectivity;
    for (const auto id : ids(EX_ELEM_BLOCK, sizes.num_elem_blk)) {
      ex_block block{};
      block.id = id;
      block.type = EX_ELEM_BLOCK;
      check(ex_get_block_param(id_, &block), fmt::format("block {}", id));
      if (block.num_entry == 0) continue;
      const std::string called = name(EX_ELEM_BLOCK, id, "block"), type = lower_case(block.topology);
      if (!type.starts_with("hex") || block.num_nodes_per_entry != 8)
        throw InputError({.problem = fmt::format("block {} (\"{}\") has {} elements of type {} with {} nodes", id, called, block.num_entry, block.topology,
                                                 block.num_nodes_per_entry),
                          .range = "HEX8, hexahedra of 8 nodes",
                          .suggestion = "mesh this part with linear hexahedra, or leave it out of the file",
                          .file = mesh_.path.string()});
      if (mesh_.elements.size() + std::size_t(block.num_entry) > count) fail("its blocks hold more elements than its header states", damaged);
      connectivity.resize(8 * std::size_t(block.num_entry));
      check(ex_get_conn(id_, EX_ELEM_BLOCK, id, connectivity.data(), nullptr, nullptr), fmt::format("the elements of block {}", id));
      auto& set = mesh_.element_sets[called];
      for (std::size_t e = 0; e < std::size_t(block.num_entry); ++e) {
        std::array<NodeId, 8> corners{};
        for (std::size_t a = 0; a < 8; ++a) {
          const auto n = connectivity[8 * e + a];
          if (n < 1 || n > std::int64_t(mesh_.nodes.size()))
            fail(fmt::format("element {} of block {} names node {} of {}", e + 1, id, n, mesh_.nodes.size()), damaged);
          corners[file_order::corner[a]] = NodeId(n - 1);
        }
        set.push_back(std::int32_t(mesh_.elements.size()));
        mesh_.element_label.push_back(labels[mesh_.elements.size()]);
        mesh_.elements.push_back(corners);
      }
    }
    if (mesh_.elements.empty()) fail("the file holds no elements", "");
  }

  MeshFile mesh_;
  int id_ = -1;
  int name_length_ = 32;
};

}  // namespace

MeshFile read_exodus_mesh(const std::filesystem::path& path) { return ExodusReader(path).read(); }

}  // namespace calomel
