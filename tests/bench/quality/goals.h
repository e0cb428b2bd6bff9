/// The project's goals for quality, each measured and printed with its limit.
#pragma once

#include "tests/bench/quality/ours.h"
#include "tests/bench/quality/tables.h"

namespace rfsmooth::bench {

/// What is printed beside a goal.
inline const char* verdict(bool holds) {
  return holds ? "holds" : "MISSED";
}

/// Ratios of means to the best peer's: all cells, without equalizing, along the ray, outliers, and at edges.
void print_ratios(const Plan& plan, const Results& results, const std::string& ours,
                  const std::string& without_equalizing);

/// Runs on data of their own, after printing what each asks for.
void print_no_harm(const Plan& plan, Cases& cases, const Variant& variant);  ///< clean clouds stay
void print_thin_plate(const Plan& plan, const Variant& variant);             ///< two sides stay apart
void print_open_sheet(const Plan& plan, const Variant& variant);             ///< the rim does not shrink
void print_outliers(const Plan& plan, Cases& cases);  ///< planted ones are found, others are not
void print_repeatability(const Plan& plan, Cases& cases,
                         const Variant& variant);  ///< same bytes; cleaned stays

}  // namespace rfsmooth::bench
