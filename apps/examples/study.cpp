// study BONE PLAN: how often does an operator breach whose entries err by 1 mm and whose directions err by 2 degrees?
#include <spinaltap/spinaltap.h>

#include <cstdio>

int main(int count, char** arguments) {
  using namespace spinaltap;
  if (count != 3) return 2;
  try {
    StudySpec spec;
    spec.name = "an operator's errors";
    spec.bones = {{.file = arguments[1], .paths = {read_plan(arguments[2]).front()}}};
    spec.volume.spacing_mm = 0.2;
    spec.tool_operator.step_mm = 0.02;
    const auto errs = [](StudyFactor factor, double deviation) {
      return FactorDistribution{.factor = factor, .kind = FactorDistribution::Kind::normal, .a = 0.0, .b = deviation};
    };
    spec.design.distributions = {errs(StudyFactor::entry_left_mm, 1.0), errs(StudyFactor::entry_head_mm, 1.0),
                                 errs(StudyFactor::angle_left_deg, 2.0), errs(StudyFactor::angle_head_deg, 2.0)};
    spec.design.runs = 40;
    const Study study(spec);
    std::size_t breaches = 0;
    for (const StudyRow& row : study.run()) breaches += row[StudyColumn::breach] > 0.0 ? 1U : 0U;
    std::printf("%zu of %zu runs breach\n", breaches, study.run_count());
  } catch (const Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}
