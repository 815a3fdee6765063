#include "kernels/exact_form.h"

namespace oktett {

ExactForm::ExactForm() = default;
ExactForm::ExactForm(const ExactForm&) = default;
ExactForm::ExactForm(ExactForm&&) noexcept = default;
ExactForm& ExactForm::operator=(const ExactForm&) = default;
ExactForm& ExactForm::operator=(ExactForm&&) noexcept = default;
ExactForm::~ExactForm() = default;

}  // namespace oktett
