//! The layer that every request passes: it makes the checks of [`crate::access`] and adds headers to every answer.

use std::sync::Arc;

use axum::body::Body;
use axum::extract::{Request, State};
use axum::http::{HeaderName, HeaderValue, Method, StatusCode, header};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};

use crate::answers::refused;
use crate::studio::Studio;

/// What the page may load, and from where. `blob:` is for pictures and workers that the page makes itself.
const POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; \
                      connect-src 'self'; worker-src 'self' blob:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

const WRONG_TOKEN: &str =
    "the token of this start is missing; open the address that `grainpath studio` printed";

/// The value of `token` in a query.
fn token_of(query: &str) -> Option<&str> {
    query.split('&').find_map(|pair| pair.strip_prefix("token="))
}

/// Checks a request and adds the headers that every response has.
pub(crate) async fn check(State(studio): State<Arc<Studio>>, request: Request, next: Next) -> Response {
    let method = request.method().clone();
    let mut response = in_json(&method, checked(&studio, request, next).await).await;
    let headers = response.headers_mut();
    let fixed = [
        (header::CONTENT_SECURITY_POLICY, POLICY),
        (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
        (header::REFERRER_POLICY, "no-referrer"),
        (HeaderName::from_static("cross-origin-resource-policy"), "same-origin"),
        (HeaderName::from_static("cross-origin-opener-policy"), "same-origin"),
    ];
    for (name, value) in fixed {
        headers.insert(name, HeaderValue::from_static(value));
    }
    headers.entry(header::CACHE_CONTROL).or_insert(HeaderValue::from_static("no-store"));
    response
}

/// Longest text of an error of axum that is passed on, bytes. Source: chosen; they have one line.
const MOST_ERROR_BYTES: usize = 4096;

/// An error of axum itself, of an address or a method that does not fit, in the form of all others.
async fn in_json(method: &Method, response: Response) -> Response {
    let status = response.status();
    let kind = response.headers().get(header::CONTENT_TYPE).cloned();
    let is_json = kind.is_some_and(|kind| kind.as_bytes().starts_with(b"application/json"));
    if !status.is_client_error() || is_json {
        return response;
    }
    let (mut parts, body) = response.into_parts();
    let text = axum::body::to_bytes(body, MOST_ERROR_BYTES).await.unwrap_or_default();
    let text = String::from_utf8_lossy(&text).into_owned();
    let message = match status {
        StatusCode::METHOD_NOT_ALLOWED => {
            format!("this address does not take {method}; docs/studio.md lists what it takes")
        }
        _ => text,
    };
    let (own, body) = refused(status, &message).into_parts();
    parts.headers.remove(header::CONTENT_LENGTH);
    parts.headers.extend(own.headers);
    Response::from_parts(parts, body)
}

async fn checked(studio: &Studio, request: Request, next: Next) -> Response {
    let access = &studio.access;
    if let Some(why) = access.foreign(request.headers()) {
        return refused(StatusCode::FORBIDDEN, why);
    }
    let top = format!("{}/", studio.base);
    // This is the printed address. Its token becomes a cookie, so that it is not left in the address bar or the history.
    let given = request.uri().query().and_then(token_of);
    if let Some(token) = given.filter(|_| request.uri().path() == top && request.method() == Method::GET) {
        if !access.is_token(token) {
            return refused(StatusCode::UNAUTHORIZED, WRONG_TOKEN);
        }
        let cookie = format!("{}={token}; HttpOnly; SameSite=Strict; Path={top}", access.cookie());
        let headers = [(header::SET_COOKIE, cookie), (header::LOCATION, top)];
        return (StatusCode::SEE_OTHER, headers, Body::empty()).into_response();
    }
    if !access.has_token(request.headers(), &access.cookie()) {
        return refused(StatusCode::UNAUTHORIZED, WRONG_TOKEN);
    }
    next.run(request).await
}
