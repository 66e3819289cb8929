//! Checks who may send requests: a valid token, an allowed `Host`, and no foreign `Origin`.
//!
//! Every page that the user's browser shows can send requests to 127.0.0.1. Three checks keep such pages out. The token
//! is random and new at each start. The address that is opened first carries it; later it is in a cookie that scripts
//! cannot read (`HttpOnly`, `SameSite=Strict`), or in `Authorization: Bearer`. `Host` must name this computer, which
//! prevents DNS rebinding; any port is allowed, so that `ssh -L` works. `Origin`, if sent, must be the address of `Host`.
//! No response allows another origin, and the content security policy lets the page load from this server alone.

use axum::http::{HeaderMap, HeaderName, header};

/// Host names of this computer.
const OWN_HOSTS: [&str; 3] = ["127.0.0.1", "localhost", "[::1]"];
/// Bytes of a token. Source: 128 bits cannot be guessed (RFC 6819, section 5.1.4.2.2).
const TOKEN_BYTES: usize = 16;
/// The checks of a server.
#[derive(Debug, Clone)]
pub struct Access {
    token: String,
    hosts: Vec<String>,
}

impl Access {
    /// A new random token; `hosts` are names that are allowed besides those of this computer.
    ///
    /// # Errors
    /// Where the system gives no random bytes.
    pub fn new(hosts: &[String]) -> Result<Self, getrandom::Error> {
        let mut bytes = [0; TOKEN_BYTES];
        getrandom::fill(&mut bytes)?;
        let token = bytes.iter().map(|b| format!("{b:02x}")).collect();
        let own = OWN_HOSTS.iter().map(|h| (*h).to_owned());
        let hosts = own.chain(hosts.iter().map(|h| h.to_ascii_lowercase())).collect();
        Ok(Self { token, hosts })
    }

    /// The token.
    pub fn token(&self) -> &str {
        &self.token
    }

    /// Whether `given` is the token. All bytes are compared, so that the time taken reveals nothing of it.
    pub fn is_token(&self, given: &str) -> bool {
        let differing = self.token.bytes().zip(given.bytes()).fold(0, |d, (a, b)| d | (a ^ b));
        given.len() == self.token.len() && differing == 0
    }

    fn allows_host(&self, host: &str) -> bool {
        let host = host.to_ascii_lowercase();
        // A port follows the last colon; an IPv6 address has its colons in brackets.
        let name = match host.rfind(':') {
            Some(at) if !host[at..].contains(']') => &host[..at],
            _ => &host,
        };
        self.hosts.iter().any(|h| h.as_str() == name)
    }

    /// The reason why a request is refused by its headers, before its token is checked; `None` if there is none.
    pub(crate) fn foreign(&self, headers: &HeaderMap) -> Option<&'static str> {
        let text = |name: HeaderName| headers.get(name).map(|v| v.to_str().unwrap_or_default());
        let Some(host) = text(header::HOST).filter(|h| self.allows_host(h)) else {
            return Some("this host name is not allowed; --allow-host NAME allows it");
        };
        let origin = text(header::ORIGIN)?;
        let authority = origin.strip_prefix("http://").or(origin.strip_prefix("https://"));
        let is_own = authority.is_some_and(|a| a.eq_ignore_ascii_case(host));
        (!is_own).then_some("requests of other pages are refused")
    }

    pub(crate) fn has_token(&self, headers: &HeaderMap, name: &str) -> bool {
        let given = headers.get(header::AUTHORIZATION).and_then(|v| v.to_str().ok()?.split_once(' '));
        // The name of a scheme may be in any case (RFC 9110, section 11.1).
        if given.is_some_and(|(scheme, t)| scheme.eq_ignore_ascii_case("bearer") && self.is_token(t.trim())) {
            return true;
        }
        let cookies = headers.get_all(header::COOKIE).iter().filter_map(|v| v.to_str().ok());
        let mut pairs = cookies.flat_map(|c| c.split(';')).filter_map(|c| c.trim().split_once('='));
        pairs.any(|(key, value)| key == name && self.is_token(value))
    }

    /// The name of the cookie. Browsers share cookies between ports, so two studios need two names. The name holds
    /// the start of the token; this reveals nothing, because the cookie itself holds the whole token.
    pub(crate) fn cookie(&self) -> String {
        format!("grainpath_{}", &self.token[..4])
    }
}

#[cfg(test)]
mod tests {
    use axum::http::HeaderValue;

    use super::*;

    fn headers(pairs: &[(&'static str, &str)]) -> HeaderMap {
        let pair = |(name, value): &(&'static str, &str)| {
            (HeaderName::from_static(name), HeaderValue::from_str(value).expect("a value"))
        };
        pairs.iter().map(pair).collect()
    }

    #[test]
    fn hosts_of_this_computer_are_allowed_with_any_port() {
        let access = Access::new(&["Lab.example".to_owned()]).expect("random bytes");
        for host in
            ["127.0.0.1", "127.0.0.1:8080", "localhost:1", "LOCALHOST", "[::1]:9", "[::1]", "lab.example:443"]
        {
            assert_eq!(access.foreign(&headers(&[("host", host)])), None, "{host}");
        }
        for host in
            ["evil.example", "127.0.0.1.evil.example", "localhost.evil.example:80", "", "::1", "0.0.0.0"]
        {
            assert!(access.foreign(&headers(&[("host", host)])).is_some(), "{host}");
        }
        assert!(access.foreign(&HeaderMap::new()).is_some());
    }

    #[test]
    fn the_scheme_of_a_token_is_in_any_case() {
        let access = Access::new(&[]).expect("random bytes");
        let has = |words: String| access.has_token(&headers(&[("authorization", &words)]), "cookie");
        for scheme in ["Bearer", "bearer", "BEARER"] {
            assert!(has(format!("{scheme} {}", access.token())), "{scheme}");
        }
        assert!(!has(format!("Basic {}", access.token())));
        assert!(!has(access.token().to_owned()));
    }

    #[test]
    fn origins_must_be_the_host() {
        let access = Access::new(&[]).expect("random bytes");
        let with = |origin| access.foreign(&headers(&[("host", "localhost:80"), ("origin", origin)]));
        assert_eq!(with("http://localhost:80"), None);
        for origin in ["http://evil.example", "null", "http://localhost:81", "http://127.0.0.1:80", "file://"]
        {
            assert!(with(origin).is_some(), "{origin}");
        }
    }

    #[test]
    fn tokens_are_new_and_compared_whole() {
        let (a, b) = (Access::new(&[]).expect("random"), Access::new(&[]).expect("random"));
        assert_ne!(a.token(), b.token());
        assert_eq!(a.token().len(), 2 * TOKEN_BYTES);
        assert!(a.is_token(a.token()));
        for wrong in ["", b.token(), &a.token()[1..], &format!("{}0", a.token())] {
            assert!(!a.is_token(wrong), "{wrong}");
        }
    }
}
