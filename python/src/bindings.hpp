// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cxxabi.h>
#include <pybind11/pybind11.h>
#include <unistd.h>

#include <palpate/observer/estimate.hpp>
#include <palpate/recording/catheter_file.hpp>
#include <palpate/recording/tracker_recording.hpp>
#include <span>

/// One function a room puts its names into the module; the Python files beside it give them their final shape.
namespace palpate::python {

namespace py = pybind11;

/// A recording, and whether its readings are already those of one catheter, in its order.
struct Recording {
  TrackerRecording data;
  bool bound = false;
  bool of_session = false;                     ///< a live run that was kept, whose frames have further times:
  std::vector<double> output_time_s = {};      ///< that went out with the force [s since 1970, UTC]
  std::vector<std::int64_t> received_ns = {};  ///< the host's clock when the frame came [ns since 1970, UTC]
};

/// Without Python's lock for as long as it lives. Where Python has begun to end meanwhile, the lock never comes back:
/// up to 3.13 Python then ends the thread by unwinding its stack, which no destructor lets pass (std::terminate); as
/// newer ones do, the thread waits for the process to end instead.
class OthersRun {
 public:
  OthersRun() : thread_(PyEval_SaveThread()) {}
  OthersRun(const OthersRun&) = delete;
  OthersRun& operator=(const OthersRun&) = delete;
  ~OthersRun() {
    try {
      PyEval_RestoreThread(thread_);
    } catch (const abi::__forced_unwind&) {
      while (true) pause();
    }
  }

 private:
  PyThreadState* thread_;
};

void bind_catheter(py::module_& m);
void bind_rod(py::module_& m);
void bind_batch(py::module_& m);
void bind_observer(py::module_& m);
void bind_recording(py::module_& m);
void bind_session(py::module_& m);
void bind_estimation(py::module_& m);
void bind_identification(py::module_& m);
void bind_shaft_identification(py::module_& m);
void bind_simulation(py::module_& m);
void bind_evaluation(py::module_& m);
/// Of all classes that were bound before it.
void bind_pickle(py::module_& m);

/// Puts keyword options in place of those given. Throws InputError on an unknown name or a value out of range.
void set_options(const py::dict& values, ObserverOptions& options);
py::dict as_dict(const ObserverOptions& options);

/// Each column of the estimates by name; `status` as numbers.
py::dict estimate_columns(std::span<const Estimate> estimates);

/// One catheter's sensors, a tracked base last: what a frame must bring.
std::size_t readings_of(const Catheter& catheter);
/// Throws InputError where the frame brings another number of readings.
void require_readings(const Catheter& catheter, std::size_t readings, const char* argument);

}  // namespace palpate::python
