// SPDX-FileCopyrightText: The calibrd authors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>

#include "core/registration/linearization.hpp"

namespace calibrd {

/// What the scatter of residuals shows of a sensor's noise, and what observations are worth by it.
struct SensorNoise {
  /// Of one kind of edges.
  struct Edges {
    double sigma_px = 0.5;
    double correlation = 1;  ///< times that errors are less independent than their number says
  };

  double sigma_factor = 1;  ///< over depth_sigma_m()
  double lateral_px = kUsualLateral_px;
  double range_correlation = 1;                  ///< as Edges::correlation
  std::array<Edges, kEdgeSources.size()> edges;  ///< by EdgeSource

  void note_edges(const ViewSums& sums);

  /// `around`: observed with this noise; `sums`: its sums where it was made; `range_alone`: how far from
  /// there range alone would have the parameters. Judged anywhere else, a pull between range and outline
  /// would pass for correlated noise, take the range's weight, and so grow.
  SensorNoise found_in(const Linearization& around, const ViewSums& sums,
                       const ParameterVector& range_alone) const;

  /// Factor on the range's weights.
  double range_weight(const ViewSums& sums) const;
  /// Edges, and range with edges, each by what its own scatter says it is worth.
  NormalEquations weighed_edges(const ViewSums& sums) const;
  NormalEquations weighed(const ViewSums& sums) const;
};

}  // namespace calibrd
