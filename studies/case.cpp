#include "studies/case.hpp"

#include <ctime>
#include <exception>

#include "io/start.hpp"
#include "solver/steady_flow.hpp"

namespace hourglass {
namespace {

double cpu_clock() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

class SeriesKeeper : public Observer {
 public:
  explicit SeriesKeeper(std::vector<SeriesRow>& rows) : rows_(rows) {}
  void on_series(const SeriesRow& row) override { rows_.push_back(row); }

 private:
  std::vector<SeriesRow>& rows_;
};

}  // namespace

CaseResult run_case(const Scene& scene, const CaseOptions& options) {
  CaseResult result;
  const double start = cpu_clock();
  SeriesKeeper rows(result.series);
  std::vector<Observer*> observers = options.observers;
  observers.push_back(&rows);
  try {
    if (scene.model != Model::mu_I) {
      const SteadyFlow flow = steady_flow(scene);
      for (Observer* observer : observers) observer->on_series(flow.row);
      result.summary = flow.summary;
      result.cpu_seconds = cpu_clock() - start;
      return result;
    }
    Simulation simulation(scene);
    begin(simulation);
    if (options.prepare) options.prepare(simulation);
    result.summary = simulation.run(observers);
    if (options.at_end) options.at_end(simulation);
  } catch (const std::exception& error) {
    result.summary.status = Status::interrupted;
    result.summary.reason = error.what();
  }
  result.cpu_seconds = cpu_clock() - start;
  return result;
}

}  // namespace hourglass
