#pragma once
/// \file What requests are answered, and how.

#include <string>

#include "app/view/http.h"
#include "app/view/session.h"

namespace oktett {

/// A word that nobody can guess: 128 random bits as hexadecimal digits. Throws Error.
std::string random_token();

/// Answers pages. All addresses begin with the token, so programs and other pages that do not know it see
/// nothing.
class Routes {
 public:
  Routes(Session& session, std::string token, int port)
      : session_(session), token_(std::move(token)), port_(port) {}

  /// 0 if the request may pass, else the status of its refusal: the address must begin with the token, Host
  /// must be this server, as must the page that a request comes from.
  int gate(const HttpRequest& request) const;
  /// Answers a request that has passed.
  HttpResponse answer(const HttpRequest& request);

 private:
  HttpResponse get(const std::string& name, const HttpRequest& request);
  std::string status_json() const;

  Session& session_;
  std::string token_;
  int port_;
};

}  // namespace oktett
