#include "apps/report/parts/html.hpp"

#include <gmock/gmock.h>

#include <string>
#include <type_traits>
#include <vector>

#include "base/errors.hpp"

using namespace calomel;

// Only trusted_html() makes markup of a string.
static_assert(!std::is_convertible_v<Html, std::string>);
static_assert(!std::is_constructible_v<Html, std::string, bool>);

TEST(Html, TextIsEscaped) {
  EXPECT_EQ(Html("a < b & c > \"d\" 'e'").str(), "a &lt; b &amp; c &gt; &quot;d&quot; &#39;e&#39;");
  EXPECT_EQ(Html(std::string("<script>")).str(), "&lt;script&gt;");
  EXPECT_EQ(Html("&lt;").str(), "&amp;lt;");
  EXPECT_EQ(Html("\u03c1c\n").str(), "\u03c1c\n");
  EXPECT_TRUE(Html().empty());
  EXPECT_TRUE(Html("").empty());
}

TEST(Html, HtmlIsNotEscapedAgain) {
  const Html once("a & b");
  EXPECT_EQ(Html(once).str(), "a &amp; b");
  EXPECT_EQ(fragment(once, once).str(), "a &amp; ba &amp; b");
  EXPECT_EQ(element("p", element("b", once)).str(), "<p><b>a &amp; b</b></p>");
}

TEST(Html, ElementsNest) {
  EXPECT_EQ(element("td", "1 < 2").str(), "<td>1 &lt; 2</td>");
  EXPECT_EQ(element("ul", "\n", element("li", "a"), element("li", "b")).str(), "<ul>\n<li>a</li><li>b</li></ul>");
  EXPECT_EQ(element("div").str(), "<div></div>");
}

TEST(Html, AttributesKeepTheirOrderAndTheirValuesAreEscaped) {
  EXPECT_EQ(element("td", {{"class", "text"}, {"id", "a"}}, "x").str(), "<td class=\"text\" id=\"a\">x</td>");
  EXPECT_EQ(element("div", {{"aria-label", "\"><script>'&"}}).str(), "<div aria-label=\"&quot;&gt;&lt;script&gt;&#39;&amp;\"></div>");
  const HtmlAttributes none;
  EXPECT_EQ(element("p", none, "x").str(), "<p>x</p>");
}

TEST(Html, NamesThatWouldBeMarkupAreRefused) {
  EXPECT_THROW(element("p onclick", "x"), ContractFailure);
  EXPECT_THROW(element("", "x"), ContractFailure);
  EXPECT_THROW(element("p", {{"a=\"", "x"}}), ContractFailure);
}

TEST(Html, PartsAreJoinedInOrder) {
  EXPECT_EQ(fragment("a", std::string("<"), element("b", "c")).str(), "a&lt;<b>c</b>");
  EXPECT_EQ(("<" + element("b", "c") + ">").str(), "&lt;<b>c</b>&gt;");
  EXPECT_EQ(joined({"a", element("b", "c"), "<"}, " & ").str(), "a &amp; <b>c</b> &amp; &lt;");
  EXPECT_TRUE(joined({}, ", ").empty());
}

TEST(Html, TrustedMarkupIsNotEscaped) { EXPECT_EQ(trusted_html("<b>\"x\" & y</b>").str(), "<b>\"x\" & y</b>"); }
