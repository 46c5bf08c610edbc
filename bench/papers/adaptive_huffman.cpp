#include "papers/adaptive_huffman.h"

#include <bit>
#include <cstddef>
#include <unordered_map>
#include <utility>

namespace occlod::paper {
namespace {

constexpr std::uint32_t none = 0xffffffffU;

// The tree that sender and receiver have after the same numbers. Nodes stand in the order of their weights, the root
// first, siblings side by side: the sibling property of Gallager (1978), which makes it a Huffman tree.
class Tree {
 public:
  Tree() { nodes_.push_back({}); }

  // The leaf of a number, or of those that have not come yet.
  [[nodiscard]] std::uint32_t leaf_of(std::uint32_t number) const {
    const auto found = leaves_.find(number);
    return found == leaves_.end() ? escape_ : found->second;
  }
  [[nodiscard]] bool is_escape(std::uint32_t node) const { return node == escape_; }
  [[nodiscard]] bool is_leaf(std::uint32_t node) const { return nodes_[node].left == none; }
  [[nodiscard]] std::uint32_t number(std::uint32_t node) const { return nodes_[node].number; }
  // Child 0 or 1.
  [[nodiscard]] std::uint32_t child(std::uint32_t node, bool bit) const { return nodes_[node].left + (bit ? 0 : 1); }
  [[nodiscard]] std::uint32_t parent(std::uint32_t node) const { return nodes_[node].parent; }
  [[nodiscard]] bool bit_to(std::uint32_t node) const { return nodes_[nodes_[node].parent].left == node; }

  // After the number has been sent.
  void count(std::uint32_t number) {
    std::uint32_t node = leaf_of(number);
    if (node == escape_) node = insert(number);
    while (node != none) {
      node = move_to_front(node);
      ++nodes_[node].weight;
      node = nodes_[node].parent;
    }
  }

 private:
  struct Node {
    std::uint64_t weight = 0;
    std::uint32_t parent = none;
    std::uint32_t left = none;  // the right child is the next one; none: a leaf
    std::uint32_t number = 0;   // of a leaf, 0 of the escape
  };

  // The escape gets two children: the number, before it in the order, and itself.
  std::uint32_t insert(std::uint32_t number) {
    const std::uint32_t parent = escape_, leaf = static_cast<std::uint32_t>(nodes_.size());
    nodes_.push_back({0, parent, none, number});
    nodes_.push_back({0, parent, none, 0});
    nodes_[parent].left = leaf;
    leaves_[number] = leaf;
    escape_ = leaf + 1;
    return leaf;
  }
  // Exchanges the node with the first one of its weight that is not an ancestor; gives its new place.
  std::uint32_t move_to_front(std::uint32_t node) {
    std::uint32_t first = node;
    while (first > 0 && nodes_[first - 1].weight == nodes_[node].weight) --first;
    if (first == nodes_[node].parent) ++first;  // the parent has the node's weight where the sibling is the escape
    if (first < node) exchange(first, node);
    return first < node ? first : node;
  }
  void exchange(std::uint32_t a, std::uint32_t b) {
    std::swap(nodes_[a].weight, nodes_[b].weight);
    std::swap(nodes_[a].left, nodes_[b].left);
    std::swap(nodes_[a].number, nodes_[b].number);
    for (const std::uint32_t node : {a, b}) {
      if (nodes_[node].left != none) {
        nodes_[nodes_[node].left].parent = node;
        nodes_[nodes_[node].left + 1].parent = node;
      } else if (nodes_[node].number == 0) {
        escape_ = node;
      } else {
        leaves_[nodes_[node].number] = node;
      }
    }
  }

  std::vector<Node> nodes_;
  std::uint32_t escape_ = 0;
  std::unordered_map<std::uint32_t, std::uint32_t> leaves_;
};

void write_path(BitString& bits, const Tree& tree, std::uint32_t node) {
  std::vector<bool> path;
  for (; tree.parent(node) != none; node = tree.parent(node)) path.push_back(tree.bit_to(node));
  for (std::size_t i = path.size(); i-- > 0;) bits.push(path[i]);
}

void write_gamma(BitString& bits, std::uint32_t number) {
  const int length = static_cast<int>(std::bit_width(number));
  for (int i = 1; i < length; ++i) bits.push(false);
  for (int i = length - 1; i >= 0; --i) bits.push(((number >> i) & 1U) != 0);
}

std::uint32_t read_gamma(const BitString& bits, std::size_t& at) {
  int length = 1;
  for (; !bits[at]; ++at) ++length;
  std::uint32_t number = 0;
  for (int i = 0; i < length; ++i) number = 2 * number + (bits[at++] ? 1U : 0U);
  return number;
}

}  // namespace

BitString encode_adaptive(std::span<const std::uint32_t> numbers) {
  BitString bits;
  Tree tree;
  for (const std::uint32_t number : numbers) {
    const std::uint32_t leaf = tree.leaf_of(number);
    write_path(bits, tree, leaf);
    if (tree.is_escape(leaf)) write_gamma(bits, number);
    tree.count(number);
  }
  return bits;
}

std::vector<std::uint32_t> decode_adaptive(const BitString& bits) {
  std::vector<std::uint32_t> numbers;
  Tree tree;
  for (std::size_t at = 0; at < bits.size();) {
    std::uint32_t node = 0;
    while (!tree.is_leaf(node)) node = tree.child(node, bits[at++]);
    numbers.push_back(tree.is_escape(node) ? read_gamma(bits, at) : tree.number(node));
    tree.count(numbers.back());
  }
  return numbers;
}

}  // namespace occlod::paper
