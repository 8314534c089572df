#pragma once
/// Options whose type is known to their owner alone, so that an entry of a registry can bring its own table of the case file.
#include <concepts>
#include <memory>
#include <type_traits>
#include <utility>

#include "base/case_file.hpp"

namespace calomel {

/// A copyable value that holds Options of any type and replaces them in every visitor: it is read, echoed, documented and searched for numbers like the
/// Options that it holds. Invariant: it always holds Options, those without keys by default.
class AnyOptions {
 public:
  AnyOptions() : AnyOptions(NoKeys{}) {}
  template <class O>
  requires(!std::same_as<std::remove_cvref_t<O>, AnyOptions>) AnyOptions(O options) : held_(std::make_unique<Held<O>>(std::move(options))) {}
  AnyOptions(const AnyOptions& other) : held_(other.held_->copy()) {}
  AnyOptions& operator=(const AnyOptions& other) {
    held_ = other.held_->copy();
    return *this;
  }

  /// The options as their own type; null where they are of another.
  template <class O>
  [[nodiscard]] O* as() {
    auto* held = dynamic_cast<Held<O>*>(held_.get());
    return held ? &held->options : nullptr;
  }
  template <class O>
  [[nodiscard]] const O* as() const {
    const auto* held = dynamic_cast<const Held<O>*>(held_.get());
    return held ? &held->options : nullptr;
  }

  void visit(CaseFile::Reader& v) { held_->visit(v); }
  void visit(EchoVisitor& v) { held_->visit(v); }
  void visit(NumberVisitor& v) { held_->visit(v); }
  void visit(ReferenceVisitor& v) { held_->visit(v); }
  /// Errors: those of the held options' own validate(), if they have one.
  void validate() const { held_->validate(); }

 private:
  struct Base {
    virtual ~Base() = default;
    [[nodiscard]] virtual std::unique_ptr<Base> copy() const = 0;
    virtual void visit(CaseFile::Reader& v) = 0;
    virtual void visit(EchoVisitor& v) = 0;
    virtual void visit(NumberVisitor& v) = 0;
    virtual void visit(ReferenceVisitor& v) = 0;
    virtual void validate() const = 0;
  };
  template <class O>
  struct Held final : Base {
    O options;
    explicit Held(O o) : options(std::move(o)) {}
    [[nodiscard]] std::unique_ptr<Base> copy() const override { return std::make_unique<Held>(options); }
    void visit(CaseFile::Reader& v) override { options.visit(v); }
    void visit(EchoVisitor& v) override { options.visit(v); }
    void visit(NumberVisitor& v) override { options.visit(v); }
    void visit(ReferenceVisitor& v) override { options.visit(v); }
    void validate() const override {
      if constexpr (requires { options.validate(); }) options.validate();
    }
  };
  std::unique_ptr<Base> held_;
};

}  // namespace calomel
