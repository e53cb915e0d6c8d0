// SPDX-License-Identifier: Apache-2.0
#include <palpate/evaluation/force_size.hpp>
#include <palpate/math/errors.hpp>

#include "arrays.hpp"
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

/// The class outlives the module, as pybind11's own are kept. A message may quote a file of another encoding.
void register_input_error(py::module_& m) {
  static const py::handle kind = py::exception<InputError>(m, "InputError", PyExc_ValueError).release();
  kind.attr("__doc__") =
      "Bad input: a file, an argument or an option that cannot be used. The message stands alone: it names the place, "
      "the value found and what was expected, in the words of the command line.";
  // The signature is pybind11's: NOLINTNEXTLINE(performance-unnecessary-value-param)
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const InputError& error) {
      PyErr_SetObject(kind.ptr(), shown(error.what()).ptr());
    }
  });
}

}  // namespace
}  // namespace palpate::python

PYBIND11_MODULE(_palpate, m) {
  using namespace palpate::python;
  m.doc() = "What of Palpate is compiled. Use the package palpate, which gives these names their final shape.";
  register_input_error(m);
  bind_catheter(m);
  bind_rod(m);
  bind_batch(m);
  bind_recording(m);
  bind_session(m);
  bind_observer(m);
  bind_estimation(m);
  bind_evaluation(m);
  bind_identification(m);
  bind_shaft_identification(m);
  bind_simulation(m);
  bind_pickle(m);
  m.attr("STATUSES") = status_words();
  m.attr("SOURCES") = source_words();
  m.attr("version") = PALPATE_VERSION;
}
