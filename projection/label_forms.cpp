#include "projection/label_forms.h"

namespace planlight {

bool warns(const LabelWish& wish) {
    return wish.text.risk && wish.text.risk->warns;
}

LabelWish in_form(LabelWish wish, LabelForm form) {
    using Form = LabelForm;
    if (form == Form::whole) return wish;
    const bool warning = (form == Form::spare || form == Form::brief) && warns(wish);
    if (!warning) wish.text.risk.reset();
    if (form == Form::brief && warning)
        wish.text.risk->structure = "risk", wish.text.risk->more.clear(), wish.text.risk->apart = true;
    if (wish.text.name.empty() ? warning : warning || form == Form::name || form == Form::code)
        wish.text.figures.clear();
    if (form == Form::code && !wish.text.name.empty() && !wish.code.empty()) wish.text.name = wish.code;
    return wish;
}

std::vector<LabelForm> forms_of(const LabelWish& wish) {
    using Form = LabelForm;
    if (warns(wish)) return {Form::whole, Form::spare, Form::brief, Form::name, Form::code};
    if (wish.text.risk) return {Form::whole, Form::spare, Form::name, Form::code};
    return {Form::whole, Form::name, Form::code};
}

}  // namespace planlight
