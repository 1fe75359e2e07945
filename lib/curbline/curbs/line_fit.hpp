// Total least squares fit of a line to points: what a chain of border points becomes.
#pragma once

namespace curbline {

class LineFit {
 public:
  struct Segment {
    float x0_m, y0_m, x1_m, y1_m;
    float normal_x, normal_y;  ///< unit normal, to the left looking from the first end to the second

    bool has_direction() const { return normal_x != 0.0f || normal_y != 0.0f; }
    /// Lengthens a line with a direction, as far as needed, to `margin_m` beyond a point's projection.
    void reach(float x_m, float y_m, float margin_m);
  };

  // Inlined: calls would cost the worst line of a Cortex-M7 14,000 instructions (tools/budget).
  [[gnu::always_inline]] void add(float x_m, float y_m, float weight = 1.0f) {
    weight_ += weight;
    const float dx = x_m - x_, dy = y_m - y_;
    x_ += weight / weight_ * dx;
    y_ += weight / weight_ * dy;
    xx_ += weight * dx * (x_m - x_);
    xy_ += weight * dx * (y_m - y_);
    yy_ += weight * dy * (y_m - y_);
  }
  /// Removes a point that was added; not the only one.
  void remove(float x_m, float y_m, float weight = 1.0f) { add(x_m, y_m, -weight); }
  float weight() const { return weight_; }
  /// Weighted sum of the points' squared distances from the line.
  float squares() const;
  /// Factor by which the variance of the line's position grows from the mean of its points to another place on it.
  float grown(float x_m, float y_m) const;
  /// Mean of the points.
  float x_m() const { return x_; }
  float y_m() const { return y_; }

  /// The line between the projections of two points on it, longer by `margin_m` at both ends. If the fit has no
  /// direction, between the points themselves, without a normal.
  Segment segment(float x0_m, float y0_m, float x1_m, float y1_m, float margin_m) const;
  /// A line for a single place, `margin_m` to both sides, with a way of any length (x if that is 0) straight to its
  /// right.
  static Segment across(float x_m, float y_m, float way_x, float way_y, float margin_m);

 private:
  float weight_ = 0.0f, x_ = 0.0f, y_ = 0.0f, xx_ = 0.0f, xy_ = 0.0f, yy_ = 0.0f;
};

}  // namespace curbline
