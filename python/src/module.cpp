// SPDX-License-Identifier: Apache-2.0
#include <palpate/evaluation/force_size.hpp>
#include <palpate/math/errors.hpp>

#include "bindings.hpp"

namespace palpate::python {
namespace {

py::list status_words() {
  py::list words;
  for (std::size_t i = 0; i < kEstimateStatuses; ++i)
    words.append(std::string(describe(static_cast<EstimateStatus>(i))));
  return words;
}

py::list source_words() {
  py::list words;
  for (std::size_t i = 0; i < kUncertaintySources; ++i)
    words.append(std::string(describe(static_cast<UncertaintySource>(i))));
  return words;
}

}  // namespace
}  // namespace palpate::python

PYBIND11_MODULE(_palpate, m) {
  using namespace palpate::python;
  m.doc() = "What of Palpate is compiled. Use the package palpate, which gives these names their final shape.";
  pybind11::register_exception<palpate::InputError>(m, "InputError", PyExc_ValueError).doc() =
      "Bad input: a file, an argument or an option that cannot be used. The message stands alone: it names the place, "
      "the value found and what was expected, in the words of the command line.";
  bind_catheter(m);
  bind_rod(m);
  bind_batch(m);
  bind_recording(m);
  bind_observer(m);
  bind_estimation(m);
  bind_evaluation(m);
  bind_identification(m);
  bind_shaft_identification(m);
  bind_simulation(m);
  m.attr("STATUSES") = status_words();
  m.attr("SOURCES") = source_words();
  m.attr("version") = PALPATE_VERSION;
}
