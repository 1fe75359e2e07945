#include "reference/segmentation.hpp"

#include <algorithm>
#include <numeric>

namespace curbline::tools::reference {
namespace {

/// Disjoint sets with the internal difference and size of each.
class Components {
 public:
  explicit Components(std::size_t n) : parent_(n), size_(n, 1), internal_(n, 0) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }

  std::size_t find(std::size_t v) {
    while (parent_[v] != v) v = parent_[v] = parent_[parent_[v]];
    return v;
  }
  std::size_t size(std::size_t root) const { return size_[root]; }
  /// Int(C) + s / |C|.
  double limit(std::size_t root, double scale) const {
    return internal_[root] + scale / static_cast<double>(size_[root]);
  }
  void join(std::size_t a, std::size_t b, double weight) {
    if (size_[a] < size_[b]) std::swap(a, b);
    parent_[b] = a;
    size_[a] += size_[b];
    internal_[a] = weight;  // edges come in ascending order
  }

 private:
  std::vector<std::size_t> parent_, size_;
  std::vector<double> internal_;
};

std::vector<int> number_by_size(Components& components, std::size_t n) {
  std::vector<std::size_t> roots;
  for (std::size_t v = 0; v < n; ++v) {
    if (components.find(v) == v) roots.push_back(v);
  }
  std::stable_sort(roots.begin(), roots.end(),
                   [&](std::size_t a, std::size_t b) { return components.size(a) > components.size(b); });
  std::vector<int> number(n), out(n);
  for (std::size_t k = 0; k < roots.size(); ++k) number[roots[k]] = static_cast<int>(k);
  for (std::size_t v = 0; v < n; ++v) out[v] = number[components.find(v)];
  return out;
}

}  // namespace

double divergence(const DemCell& a, const DemCell& b) {
  const double va = a.variance_m2(), vb = b.variance_m2(), d = a.height_m - b.height_m;
  return 0.5 * (va / vb + vb / va - 2 + d * d * (1 / va + 1 / vb));
}

std::vector<int> segment(const Dem& dem, double scale) {
  std::vector<double> weight(dem.edges.size());
  for (std::size_t e = 0; e < weight.size(); ++e)
    weight[e] = divergence(dem.cell(dem.edges[e].a), dem.cell(dem.edges[e].b));
  std::vector<std::size_t> order(weight.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t p, std::size_t q) { return weight[p] < weight[q]; });

  Components components(dem.valid.size());
  for (const std::size_t e : order) {
    const std::size_t a = components.find(dem.edges[e].a), b = components.find(dem.edges[e].b);
    if (a != b && weight[e] <= std::min(components.limit(a, scale), components.limit(b, scale)))
      components.join(a, b, weight[e]);
  }
  return number_by_size(components, dem.valid.size());
}

}  // namespace curbline::tools::reference
