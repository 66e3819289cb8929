//! Access to XML attributes, for all file formats based on XML.

use quick_xml::events::BytesStart;

/// The value of an attribute, found by its name without the namespace prefix. Known entities are resolved.
pub(crate) fn attribute(element: &BytesStart<'_>, name: &str) -> Option<String> {
    let mut all = element.attributes();
    let found =
        all.with_checks(false).filter_map(Result::ok).find(|a| a.key.local_name().as_ref() == name)?;
    Some(
        quick_xml::escape::unescape(&found.value)
            .map_or_else(|_| found.value.to_string(), |t| t.into_owned()),
    )
}
