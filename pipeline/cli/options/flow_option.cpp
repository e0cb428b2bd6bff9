/// --flow and the options of every flow, over one FlowOptions. Which options may be given is known when the
/// flow is, so what is typed waits until every option has been read.
#include <map>
#include <memory>

#include <fmt/format.h>

#include <rfsmooth/flow.h>

#include "base/fail.h"
#include "pipeline/cli/options/option.h"
#include "smoothing/partners.h"

namespace rfsmooth::cli {

namespace {

/// As typed.
struct Given {
  std::string flow;
  bool paper = false;
  std::map<std::string, std::string> options;  ///< text by name, without those that are auto
};

/// The options of the flow that `fields` has chosen, bound to them; with its modifiers.
std::vector<CommandOption> options_of(FlowOptions& fields, bool modifiers = true) {
  return std::visit([&](auto& flow) { return modifiers ? collect(flow, fields.modifiers) : collect(flow); },
                    fields.flow);
}

FlowOptions read_given(const Given& given) {
  FlowOptions fields{value_or_throw(rfsmooth::find_flow(given.flow)), {}};
  const std::vector<CommandOption> options = options_of(fields), own = options_of(fields, false);
  for (const auto& [name, text] : given.options) {
    const CommandOption* const option = find_option(options, name);
    if (option == nullptr) {
      std::vector<std::string> names;
      for (const CommandOption& o : own) names.push_back(o.name);
      fail(ErrorCode::usage, "--{} has no meaning for the flow '{}', which uses: {}", name, given.flow,
           fmt::join(names, ", "));
    }
    assign(*option, text);
  }
  for (const smoothing::Partner& p : smoothing::partners(fields))
    if (!p.on && given.options.count(std::string(p.option)) > 0)
      fail(ErrorCode::usage, "`{}` has no effect without {}", p.option, p.partner);
  if (given.paper) fields = value_or_throw(rfsmooth::as_printed(fields));
  value_or_throw(rfsmooth::validate(fields));
  return fields;
}

/// An option of some flow as all of them have it; `example` checks what is typed.
CommandOption of_any_flow(const CommandOption& example, const std::shared_ptr<FlowOptions>& fields_of_example,
                          const std::shared_ptr<Given>& given, FlowOptions& fields) {
  CommandOption o = example;
  o.optional = true;
  o.on_by_default = false;
  o.default_text = "auto";
  o.set = [given, fields_of_example, check = example.set](const CommandOption& option,
                                                          const std::string& text) {
    if (text == "auto") {
      given->options.erase(option.name);
      return;
    }
    check(option, text);
    given->options[option.name] = text;
  };
  o.get = [&fields, name = o.name]() -> std::optional<std::string> {
    for (const smoothing::Partner& p : smoothing::partners(fields))
      if (p.option == name && !p.on) return std::nullopt;  // it must not be given
    const std::vector<CommandOption> now = options_of(fields);
    const CommandOption* const option = find_option(now, name);
    return option == nullptr ? std::nullopt : option->get();
  };
  return o;
}

}  // namespace

void OptionCollector::operator()(FlowOptions& field) {
  const auto given = std::make_shared<Given>(Given{std::string(name_of(field.flow)), false, {}});
  CommandOption flow;
  flow.name = "flow";
  flow.help = "how the mesh is smoothed (see `rfsmooth flows`)";
  flow.kind = ValueKind::word;
  flow.default_text = given->flow;
  for (const auto& any : rfsmooth::flows()) flow.choices.emplace_back(name_of(any));
  flow.set = [given](const CommandOption&, const std::string& text) { given->flow = text; };
  flow.get = [&field] { return std::optional<std::string>(name_of(field.flow)); };
  flow.finish = [given, &field] { field = read_given(*given); };
  out_.push_back(std::move(flow));
  (*this)(OptionInfo{"paper", "exactly the equations that the flow's paper prints: --scheme printed", ""},
          given->paper);
  out_.back().get = [given, &field]() -> std::optional<std::string> {  // given: what `set` is bound to
    const std::vector<CommandOption> now = options_of(field, false);
    const CommandOption* const scheme = find_option(now, "scheme");
    return scheme != nullptr && scheme->get() == "printed" ? "true" : "false";
  };
  const auto add = [&](const std::shared_ptr<FlowOptions>& fields,
                       const std::vector<CommandOption>& options) {
    for (const CommandOption& option : options)
      if (find_option(out_, option.name) == nullptr)
        out_.push_back(of_any_flow(option, fields, given, field));
  };
  auto fields = std::make_shared<FlowOptions>();
  for (const auto& any : rfsmooth::flows()) {
    fields = std::make_shared<FlowOptions>(FlowOptions{any, {}});
    add(fields, options_of(*fields, false));
  }
  add(fields, options_of(*fields));
}

}  // namespace rfsmooth::cli
