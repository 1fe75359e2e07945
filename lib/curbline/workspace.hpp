// Memory that stages use one after the other within a call: tilt readings and points of a line, the region graph, the
// cells that the label field visits, border points and the curbs made of them. Nothing in it outlives the call.
#pragma once

#include <new>

#include "curbline/curbs/curb_tracer.hpp"
#include "curbline/intake/line_intake.hpp"
#include "curbline/labels/label_field.hpp"
#include "curbline/regions/segmentation.hpp"

namespace curbline {

template <Limits limits>
class Workspace {
 public:
  Workspace() {}

  /// Each starts fresh, and ends the use of the others.
  typename LineIntake<limits>::Work& line() {
    return *::new (static_cast<void*>(&line_)) typename LineIntake<limits>::Work;
  }
  typename Segmentation<limits>::Work& segmentation() {
    return *::new (static_cast<void*>(&segmentation_)) typename Segmentation<limits>::Work;
  }
  typename LabelField<limits>::Visits& visits() {
    return *::new (static_cast<void*>(&visits_)) typename LabelField<limits>::Visits;
  }
  typename CurbTracer<limits>::Work& curbs() {
    return *::new (static_cast<void*>(&curbs_)) typename CurbTracer<limits>::Work;
  }

 private:
  union {
    typename LineIntake<limits>::Work line_;
    typename Segmentation<limits>::Work segmentation_;
    typename LabelField<limits>::Visits visits_;
    typename CurbTracer<limits>::Work curbs_;
  };
};

}  // namespace curbline
