// Who may come in: addresses to listen on, access tokens, browsers' origins.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <vector>

#include "navmesh/error.h"

namespace forewalk::daemon {

struct Access {
  std::string address = "127.0.0.1";
  unsigned short port = 0;           ///< that clients reach
  std::string token;                 ///< empty: none is asked for
  std::vector<std::string> origins;  ///< of pages that may open sessions, beside the daemon's own
};

/// Fails (kSettingOutOfRange) for an address that is none, for one beyond loopback without a token,
/// for a token of fewer than 16 characters or other ones than letters, digits and -._~, and for an
/// origin that is not scheme://host[:port].
[[nodiscard]] tl::expected<void, Error> validate(const Access& access);

/// Whether a browser's page may open a session. Programs other than browsers send no origin
/// (nullopt) and are let in. On loopback the daemon's own pages are, too: http:// and its port, at
/// localhost, 127.0.0.1 or [::1]. Anything else has to be in the list, letter by letter, so that no
/// page elsewhere reaches a daemon on its reader's machine.
bool originAllowed(const Access& access, const std::optional<std::string>& origin);

/// Whether the request carries the token: in `Authorization: Bearer TOKEN`, or, for browsers, as
/// the subprotocol `token.TOKEN`. Compared in constant time.
bool tokenGiven(const Access& access, std::string_view authorization,
                std::string_view subprotocols);

/// Whether a list of subprotocols, as a header has them, names this one.
bool offers(std::string_view subprotocols, std::string_view name);

/// A secret from a file (its first line), or where no file is given from an environment variable;
/// empty where there is neither. Fails where the file cannot be read or is empty.
[[nodiscard]] tl::expected<std::string, Error> secretFrom(const std::filesystem::path& file,
                                                          const char* variable);

}  // namespace forewalk::daemon
