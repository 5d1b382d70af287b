// Tokens, cookies and the limit on guesses; accepted hosts; targets of requests.
#include "viewer/server/access.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <set>
#include <string>

#include "viewer/server/host_list.h"
#include "viewer/server/request_target.h"

namespace skyquilt::viewer::server {
namespace {

using Exchange = Access::Exchange;

// The cookie that a browser would send after Set-Cookie.
std::string CookieOf(const Access::Grant& grant) {
  return grant.set_cookie.substr(0, grant.set_cookie.find(';'));
}

TEST(SecretsTest, AreLongAndDiffer) {
  std::set<std::string> secrets;
  for (int i = 0; i < 100; ++i) secrets.insert(NewSecret());
  EXPECT_EQ(secrets.size(), 100U);
  EXPECT_EQ(secrets.begin()->size(), 64U);
  EXPECT_EQ(secrets.begin()->find_first_not_of("0123456789abcdef"), std::string::npos);
}

RC_GTEST_PROP(SecretsTest, ComparisonIsEquality, (const std::string& a, const std::string& b)) {
  RC_ASSERT(EqualInConstantTime(a, b) == (a == b));
  RC_ASSERT(EqualInConstantTime(a, std::string(a)));
  RC_ASSERT(!EqualInConstantTime(a, a + "x"));
}

TEST(AccessTest, TokenWorksOnce) {
  Access access("name");
  const std::string token = access.token(Right::kView);
  Access::Grant grant;
  EXPECT_EQ(access.TryToken(token, false, {}, grant), Exchange::kGranted);
  EXPECT_NE(access.token(Right::kView), token);
  EXPECT_TRUE(access.SessionRight({CookieOf(grant)}));
  for (const char* part : {"; HttpOnly", "; SameSite=Strict", "; Path=/"}) EXPECT_NE(grant.set_cookie.find(part), std::string::npos);
  Access::Grant second;
  EXPECT_EQ(access.TryToken(token, false, {}, second), Exchange::kWrong);
  EXPECT_TRUE(second.set_cookie.empty());
}

TEST(AccessTest, EachTokenGivesItsRightAndIsRenewedAlone) {
  Access access("name", {Right::kEdit, Right::kPlay});
  const std::string edit = access.token(Right::kEdit), play = access.token(Right::kPlay);
  EXPECT_NE(edit, play);
  EXPECT_THROW(access.token(Right::kView), std::out_of_range);
  Access::Grant player, editor, again;
  ASSERT_EQ(access.TryToken(play, false, {}, player), Exchange::kGranted);
  EXPECT_EQ(player.right, Right::kPlay);
  EXPECT_EQ(access.token(Right::kEdit), edit);
  EXPECT_NE(access.token(Right::kPlay), play);
  ASSERT_EQ(access.TryToken(edit, false, {}, editor), Exchange::kGranted);
  EXPECT_EQ(editor.right, Right::kEdit);
  EXPECT_EQ(access.TryToken(edit, false, {}, again), Exchange::kWrong);
  EXPECT_EQ(access.SessionRight({CookieOf(player)}), Right::kPlay);
  EXPECT_EQ(access.SessionRight({CookieOf(editor)}), Right::kEdit);
  EXPECT_EQ(access.SessionRight({"name=x; " + CookieOf(player) + "; " + CookieOf(editor)}), Right::kPlay) << "the first that is one";
  EXPECT_FALSE(access.SessionRight({"name=" + edit})) << "a token is no session";
}

TEST(AccessTest, FindsItsCookieAmongOthers) {
  Access access("name");
  Access::Grant grant;
  access.TryToken(access.token(Right::kView), false, {}, grant);
  const std::string cookie = CookieOf(grant);
  EXPECT_TRUE(access.SessionRight({"a=b; " + cookie + "; c=d"}));
  EXPECT_TRUE(access.SessionRight({"name=old; " + cookie}));
  EXPECT_TRUE(access.SessionRight({"x=y", cookie}));
  EXPECT_FALSE(access.SessionRight({}));
  EXPECT_FALSE(access.SessionRight({""}));
  EXPECT_FALSE(access.SessionRight({"name="}));
  EXPECT_FALSE(access.SessionRight({"name"}));
  EXPECT_FALSE(access.SessionRight({"other" + cookie}));
  EXPECT_FALSE(access.SessionRight({cookie + "0"}));
  EXPECT_FALSE(access.SessionRight({cookie.substr(0, cookie.size() - 1)}));
  EXPECT_FALSE(Access("name").SessionRight({cookie}));
}

TEST(AccessTest, GuessingIsPausedForAMinute) {
  Access access("name");
  const Access::Clock::time_point start{std::chrono::hours(1)};
  Access::Grant grant;
  for (size_t i = 0; i < kMaxWrongTokens; ++i) EXPECT_EQ(access.TryToken("wrong", false, start, grant), Exchange::kWrong);
  EXPECT_EQ(access.TryToken("wrong", false, start + std::chrono::seconds(59), grant), Exchange::kTooManyGuesses);
  EXPECT_EQ(access.TryToken("wrong", true, start + std::chrono::seconds(59), grant), Exchange::kWrong);
  EXPECT_EQ(access.TryToken("wrong", false, start + std::chrono::seconds(60), grant), Exchange::kWrong);
}

TEST(AccessTest, GuessesOfOthersDoNotLockOutTheRightToken) {
  Access access("name");
  const Access::Clock::time_point start{std::chrono::hours(1)};
  Access::Grant grant;
  for (size_t i = 0; i < 2 * kMaxWrongTokens; ++i) access.TryToken("wrong", false, start, grant);
  EXPECT_EQ(access.TryToken(access.token(Right::kView), false, start, grant), Exchange::kGranted);
  EXPECT_TRUE(access.SessionRight({CookieOf(grant)}));
}

TEST(AccessTest, RareAndTrustedMistakesAreNoGuesses) {
  Access access("name");
  Access::Grant grant;
  Access::Clock::time_point now{std::chrono::hours(1)};
  for (int i = 0; i < 100; ++i) {
    EXPECT_EQ(access.TryToken("wrong", true, now, grant), Exchange::kWrong);
    EXPECT_EQ(access.TryToken("wrong", false, now, grant), Exchange::kWrong);
    now += std::chrono::seconds(4);
  }
}

TEST(AccessTest, OldestSessionIsDropped) {
  Access access("name");
  Access::Grant first, second, last;
  access.TryToken(access.token(Right::kView), false, {}, first);
  access.TryToken(access.token(Right::kView), false, {}, second);
  for (size_t i = 2; i <= kMaxSessions; ++i) access.TryToken(access.token(Right::kView), false, {}, last);
  EXPECT_FALSE(access.SessionRight({CookieOf(first)}));
  EXPECT_TRUE(access.SessionRight({CookieOf(second)}));
  EXPECT_TRUE(access.SessionRight({CookieOf(last)}));
}

TEST(HostListTest, AllowsOwnNamesWithThePortOnly) {
  const HostList hosts("127.0.0.1", 8123, {"Survey-PC", "fd00::5"});
  for (const char* host : {"127.0.0.1:8123", "localhost:8123", "LOCALHOST:8123", "survey-pc:8123", "[fd00::5]:8123"}) EXPECT_TRUE(hosts.Allows(host));
  for (const char* host : {"", "localhost", "127.0.0.1", "localhost:8124", "localhost:08123", "evil.example:8123", "localhost.evil.example:8123",
                           "localhost:8123.evil.example", "evil.example@localhost:8123", "127.0.0.1:8123 ", "[::1]:8123", "127.0.0.2:8123"}) {
    EXPECT_FALSE(hosts.Allows(host)) << host;
  }
  EXPECT_TRUE(HostList("::1", 1, {}).Allows("[::1]:1"));
  EXPECT_TRUE(HostList("::", 1, {}).Allows("[::1]:1"));
  EXPECT_TRUE(HostList("127.0.0.1", 80, {}).Allows("localhost"));
}

TEST(HostListTest, LinkLeadsToAnAddressThatOthersCanReach) {
  EXPECT_EQ(LinkHost("127.0.0.1", {"pc"}), "127.0.0.1");
  EXPECT_EQ(LinkHost("::1", {}), "[::1]");
  EXPECT_EQ(LinkHost("0.0.0.0", {}), "127.0.0.1");
  EXPECT_EQ(LinkHost("0.0.0.0", {"pc", "127.0.0.1", "192.168.1.7"}), "192.168.1.7");
  EXPECT_EQ(LinkHost("::", {"pc"}), "pc");
}

TEST(RequestTargetTest, SplitsAndDecodesOnce) {
  const auto target = ParseTarget("/data/t%69les/a-b_c.glb?x=%2e&y");
  ASSERT_TRUE(target);
  EXPECT_EQ(target->path, "/data/tiles/a-b_c.glb");
  EXPECT_EQ(target->query, "x=%2e&y");
  EXPECT_EQ(QueryValue("a=1&token=xy&token=z", "token"), "xy");
  EXPECT_EQ(QueryValue("token=", "token"), "");
  EXPECT_FALSE(QueryValue("tokens=1&atoken=2", "token"));
}

TEST(RequestTargetTest, RefusesEverythingThatCouldLeaveAFolder) {
  for (const char* target : {"",
                             "data",
                             "http://localhost/",
                             "//evil.example/",
                             "/..",
                             "/data/../x",
                             "/data/%2e%2e/x",
                             "/data/..%2fx",
                             "/data/.%2e/x",
                             "/data/%252e%252e/x",
                             "/data//etc/passwd",
                             "/data/%2fetc",
                             "/data/a%5cb",
                             "/data/a\\b",
                             "/data/%00",
                             "/data/a%",
                             "/data/a%4",
                             "/data/%zz",
                             "/data/a b",
                             "/data/~root",
                             "/data/%c0%ae%c0%ae/",
                             "/data/a;b",
                             "/data/\xff",
                             "/data/a:b",
                             "*"}) {
    EXPECT_FALSE(ParseTarget(target)) << target;
  }
  EXPECT_FALSE(ParseTarget("/" + std::string(kMaxTargetBytes, 'a')));
}

RC_GTEST_PROP(RequestTargetTest, PathsHavePlainCharacters, (const std::string& text)) {
  const auto target = ParseTarget("/" + text);
  if (!target) return;
  constexpr const char* kAllowed = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_./-";
  RC_ASSERT(target->path.find_first_not_of(kAllowed) == std::string::npos);
  RC_ASSERT(target->path.find("..") == std::string::npos);
}

}  // namespace
}  // namespace skyquilt::viewer::server
