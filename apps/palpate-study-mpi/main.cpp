// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <palpate/math/errors.hpp>
#include <palpate/study/mpi_workers.hpp>

#include "../palpate/study_run.hpp"

namespace {

int play(palpate::study::MpiJob& job, const palpate::app::StudyOptions& options) {
  if (job.rank() != 0) {
    job.serve(options.study);
    return 0;
  }
  if (job.size() < 2)
    throw palpate::InputError("--mpi: expected two ranks or more, as mpirun -n 3: rank 0 plays no runs itself");
  return run_study(options, [&](const palpate::study::Plan& plan, palpate::study::Results& results) {
    return job.workers(plan, results.fingerprint());
  });
}

/// What rank 0 refuses ends the job in good order; whatever else befalls a rank ends all of them at once.
int play_or_say_why(palpate::study::MpiJob& job, const palpate::app::StudyOptions& options) {
  try {
    return play(job, options);
  } catch (const palpate::InputError& error) {
    fmt::print(stderr, "palpate: {}{}\n", job.rank() == 0 ? "" : fmt::format("--mpi: rank {}: ", job.rank()),
               error.what());
    if (job.rank() != 0) job.abort(2);
  } catch (const std::exception& error) {
    fmt::print(stderr, "palpate: --mpi: rank {}: {}\n", job.rank(), error.what());
    job.abort(2);
  }
  return 2;
}

}  // namespace

/// What `palpate study --mpi` becomes. Exit codes as there; of what is wrong with the words rank 0 speaks.
int main(int argc, char** argv) {
  palpate::study::MpiJob job(argc, argv);
  CLI::App app{"A study over MPI; started by mpirun -n N palpate study STUDY.toml --out FILE --mpi"};
  palpate::app::StudyOptions options;
  add_study_options(app, options);
  app.footer("Example: mpirun -n 65 palpate study big.toml --out big.study --mpi");
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& success) {
    return job.rank() == 0 ? app.exit(success) : 0;  // --help
  } catch (const CLI::ParseError& error) {
    if (job.rank() == 0) fmt::print(stderr, "palpate: study --mpi: {}\n", error.what());
    return 2;
  }
  return play_or_say_why(job, options);
}
