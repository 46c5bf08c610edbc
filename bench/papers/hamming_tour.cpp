#include "papers/hamming_tour.h"

#include <algorithm>
#include <deque>
#include <numeric>
#include <random>
#include <utility>

namespace occlod::paper {
namespace {

constexpr std::uint32_t no_place = 0xffffffffU;

Neighbours nearest_of(const BitColumns& columns, std::uint32_t most, std::span<const std::uint32_t> candidates) {
  Neighbours result;
  result.most = most;
  result.of.resize(columns.size());
  std::vector<std::pair<std::uint32_t, std::uint32_t>> found;  // distance, column
  for (std::uint32_t c = 0; c < columns.size(); ++c) {
    found.clear();
    for (const std::uint32_t other : candidates)
      if (other != c) found.emplace_back(columns.distance(c, other), other);
    const std::size_t kept = std::min<std::size_t>(most, found.size());
    std::partial_sort(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(kept), found.end());
    for (std::size_t i = 0; i < kept; ++i) result.of[c].push_back(found[i].second);
  }
  return result;
}

// The columns in a circle. The empty one is always the last, so that no part that is moved goes over the end.
class Tour {
 public:
  Tour(const BitColumns& columns, const Order& order) : columns_(columns), order_(order), place_(order.size() + 1) {
    order_.push_back(columns.size());
    set_places(0, order_.size());
  }

  [[nodiscard]] std::uint32_t empty() const { return columns_.size(); }
  [[nodiscard]] std::uint32_t after(std::uint32_t c) const { return c == empty() ? order_[0] : order_[place_[c] + 1]; }
  [[nodiscard]] std::uint32_t before(std::uint32_t c) const { return place_[c] == 0 ? empty() : order_[place_[c] - 1]; }
  [[nodiscard]] std::int64_t distance(std::uint32_t a, std::uint32_t b) const {
    if (a == empty() || b == empty()) return ones(a) + ones(b);
    return columns_.distance(a, b);
  }
  // Turns round what lies from column a on to column b, or else the rest, which gives the same circle.
  void turn(std::uint32_t a, std::uint32_t b) {
    std::size_t begin = place_[a], end = place_[b] + std::size_t{1};
    if (begin >= end) {
      std::swap(begin, end);
    } else if (end == order_.size()) {
      end = begin;
      begin = 0;
    }
    std::reverse(at(begin), at(end));
    set_places(begin, end);
  }
  // Moves the columns from a on to b between `low` and the next; turned round if told so.
  void move(std::uint32_t a, std::uint32_t b, std::uint32_t low, bool turned) {
    const std::size_t first = place_[a], end = place_[b] + std::size_t{1}, length = end - first;
    const std::size_t gap = low == empty() ? 0 : place_[low] + std::size_t{1};
    const std::size_t to = gap <= first ? gap : gap - length;
    if (gap <= first) {
      std::rotate(at(gap), at(first), at(end));
    } else {
      std::rotate(at(first), at(end), at(gap));
    }
    if (turned) std::reverse(at(to), at(to + length));
    set_places(std::min(first, to), std::max(end, gap));
  }
  // Without the empty column.
  [[nodiscard]] Order order() const { return {order_.begin(), order_.end() - 1}; }

 private:
  [[nodiscard]] std::int64_t ones(std::uint32_t c) const {
    return c == empty() ? 0 : static_cast<std::int64_t>(columns_[c].size());
  }
  [[nodiscard]] Order::iterator at(std::size_t i) { return order_.begin() + static_cast<std::ptrdiff_t>(i); }
  void set_places(std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) place_[order_[i]] = static_cast<std::uint32_t>(i);
  }

  const BitColumns& columns_;
  Order order_;
  std::vector<std::uint32_t> place_;
};

// Looks for moves around one column at a time; columns whose surroundings have changed have their turn again.
class Improver {
 public:
  Improver(const BitColumns& columns, const Neighbours& neighbours, const Order& order)
      : neighbours_(neighbours), tour_(columns, order), waits_(order.size() + 1, false) {
    for (const std::uint32_t c : order) wait(c);
  }

  std::size_t run(std::size_t moves) {
    std::size_t done = 0;
    while (done < moves && !waiting_.empty()) {
      const std::uint32_t c = waiting_.front();
      waiting_.pop_front();
      waits_[c] = false;
      while (done < moves && (turn_part(c) || move_chain(c))) ++done;
    }
    return done;
  }
  [[nodiscard]] Order order() const { return tour_.order(); }

 private:
  void wait(std::uint32_t c) {
    if (c >= neighbours_.of.size() || waits_[c]) return;
    waits_[c] = true;
    waiting_.push_back(c);
  }
  // Replaces the edges c-next and n-its next by c-n and next-next, or those before likewise.
  bool turn_part(std::uint32_t c) {
    for (const bool forward : {true, false}) {
      const std::uint32_t next = step(c, forward);
      const std::int64_t have = tour_.distance(c, next);
      for (const std::uint32_t n : neighbours_.of[c]) {
        const std::int64_t near = tour_.distance(c, n);
        if (near >= have) break;
        const std::uint32_t beyond = step(n, forward);
        if (n == next || beyond == c) continue;
        if (near + tour_.distance(next, beyond) >= have + tour_.distance(n, beyond)) continue;
        if (forward)
          tour_.turn(next, n);
        else
          tour_.turn(n, next);
        for (const std::uint32_t changed : {c, next, n, beyond}) wait(changed);
        return true;
      }
    }
    return false;
  }
  // Moves a chain that begins with c and goes on to one side to between a neighbour of c and the one beside that.
  bool move_chain(std::uint32_t c) {
    for (const bool forward : {true, false}) {
      std::uint32_t end = c;
      for (int length = 1; length <= 3 && end != tour_.empty(); ++length, end = step(end, forward))
        if (try_chain(c, end, length, forward)) return true;
    }
    return false;
  }
  bool try_chain(std::uint32_t c, std::uint32_t end, int length, bool forward) {
    const std::uint32_t left = step(c, !forward), right = step(end, forward);
    const std::int64_t gain = tour_.distance(left, c) + tour_.distance(end, right) - tour_.distance(left, right);
    for (const std::uint32_t n : neighbours_.of[c]) {
      const std::int64_t near = tour_.distance(c, n);
      if (near >= gain) break;
      if (is_in_chain(n, c, length, forward)) continue;
      for (const bool after : {true, false}) {
        const std::uint32_t beyond = step(n, after);
        if (is_in_chain(beyond, c, length, forward)) continue;
        if (near + tour_.distance(end, beyond) - tour_.distance(n, beyond) >= gain) continue;
        // c beside n: the chain begins with it where it comes after n.
        tour_.move(forward ? c : end, forward ? end : c, after ? n : beyond, after != forward);
        for (const std::uint32_t changed : {c, end, left, right, n, beyond}) wait(changed);
        return true;
      }
    }
    return false;
  }
  [[nodiscard]] bool is_in_chain(std::uint32_t n, std::uint32_t c, int length, bool forward) const {
    for (int i = 0; i < length; ++i, c = step(c, forward))
      if (n == c) return true;
    return false;
  }
  [[nodiscard]] std::uint32_t step(std::uint32_t c, bool forward) const {
    return forward ? tour_.after(c) : tour_.before(c);
  }

  const Neighbours& neighbours_;
  Tour tour_;
  std::vector<bool> waits_;
  std::deque<std::uint32_t> waiting_;
};

}  // namespace

BitColumns::BitColumns(const std::vector<std::vector<std::uint32_t>>& rows) {
  first_.push_back(0);
  for (const std::vector<std::uint32_t>& column : rows) {
    rows_.insert(rows_.end(), column.begin(), column.end());
    first_.push_back(rows_.size());
  }
}

std::uint32_t BitColumns::distance(std::uint32_t a, std::uint32_t b) const noexcept {
  const std::span<const std::uint32_t> left = (*this)[a], right = (*this)[b];
  std::size_t common = 0;
  for (std::size_t i = 0, j = 0; i < left.size() && j < right.size();) {
    const std::uint32_t x = left[i], y = right[j];
    common += x == y ? 1 : 0;
    i += x <= y ? 1 : 0;
    j += y <= x ? 1 : 0;
  }
  return static_cast<std::uint32_t>(left.size() + right.size() - 2 * common);
}

std::size_t count_runs(const BitColumns& columns, const Order& order) {
  if (order.empty()) return 0;
  std::size_t length = columns[order.front()].size() + columns[order.back()].size();
  for (std::size_t i = 1; i < order.size(); ++i) length += columns.distance(order[i - 1], order[i]);
  return length / 2;
}

Neighbours nearest_columns(const BitColumns& columns, std::uint32_t most) {
  std::vector<std::uint32_t> all(columns.size());
  std::iota(all.begin(), all.end(), 0U);
  return nearest_of(columns, most, all);
}

Neighbours nearest_of_sample(const BitColumns& columns, std::uint32_t most, std::span<const std::uint32_t> sample) {
  return nearest_of(columns, most, sample);
}

std::vector<std::uint32_t> sample_columns(const BitColumns& columns, std::uint32_t count, std::uint64_t seed) {
  std::vector<std::uint32_t> all(columns.size());
  std::iota(all.begin(), all.end(), 0U);
  std::mt19937_64 random(seed);
  count = std::min(count, columns.size());
  for (std::uint32_t i = 0; i < count; ++i) std::swap(all[i], all[i + random() % (all.size() - i)]);
  all.resize(count);
  std::sort(all.begin(), all.end());
  return all;
}

Order greedy_tour(const BitColumns& columns, const Neighbours& neighbours) {
  Order order, left(columns.size());  // `left`: not visited, in no order
  std::vector<std::uint32_t> place(columns.size());
  std::iota(left.begin(), left.end(), 0U);
  std::iota(place.begin(), place.end(), 0U);
  const auto visit = [&](std::uint32_t c) {
    order.push_back(c);
    place[left.back()] = place[c];
    std::swap(left[place[c]], left.back());
    place[c] = no_place;
    left.pop_back();
  };
  if (columns.size() > 0) visit(0);
  while (!left.empty()) {
    const std::uint32_t c = order.back();
    const auto& near = neighbours.of[c];
    const auto next = std::find_if(near.begin(), near.end(), [&](std::uint32_t n) { return place[n] != no_place; });
    if (next != near.end()) {
      visit(*next);
      continue;
    }
    std::pair<std::uint32_t, std::uint32_t> best{no_place, no_place};  // distance, column
    for (const std::uint32_t n : left) best = std::min(best, {columns.distance(c, n), n});
    visit(best.second);
  }
  return order;
}

Improvement improve_tour(const BitColumns& columns, const Neighbours& neighbours, Order& order, std::size_t moves) {
  Improver improver(columns, neighbours, order);
  Improvement result;
  result.moves = improver.run(moves);
  order = improver.order();
  result.runs = count_runs(columns, order);
  return result;
}

}  // namespace occlod::paper
