// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/evaluation/shown_shape.hpp>
#include <palpate/sensing/measurement.hpp>
#include <palpate/service/board.hpp>
#include <palpate/service/page_figures.hpp>
#include <palpate/service/played_truth.hpp>

namespace palpate::service {

/// Makes the rows of one catheter (page_schema.hpp).
class PageRowMaker {
 public:
  /// `truth` may be null; it outlives this.
  PageRowMaker(const Catheter& catheter, const PlayedTruth* truth);

  /// The catheter was tared or registered anew.
  void set_catheter(const Catheter& catheter);

  /// The view's latest record. Cost: one rod solution. Valid until the next call.
  const PageRow& row(const CatheterView& view, const LiveFigures& figures, std::int64_t now_ns);
  /// The few numbers of it that make the past; no rod is solved.
  PageHistory::Row history_row(const CatheterView& view, const LiveFigures& figures, std::int64_t now_ns) const;

 private:
  void put_now(const CatheterView& view, std::int64_t now_ns);
  void put_force(const LiveFigures& figures, const Estimate& estimate);
  void put_course(const LiveFigures& figures);
  void put_shape(const CatheterView& view);
  void put_truth(const CatheterView& view);
  const PlayedTruth::Moment* truth_at(const CatheterView& view) const;

  void put(std::size_t place, double value) { row_[place] = value; }
  template <class Numbers>
  void put(std::size_t place, const Eigen::MatrixBase<Numbers>& numbers) {
    for (Eigen::Index column = 0; column < numbers.cols(); ++column)
      for (Eigen::Index i = 0; i < numbers.rows(); ++i) row_[place++] = numbers(i, column);
  }

  const PlayedTruth* truth_;
  ShownShape shape_;
  Measurement measurement_;
  PageRow row_{};
};

}  // namespace palpate::service
