// What mdBook's template leaves out for readers without a mouse: code and tables that scroll take the focus, and the switch of the
// table of contents is a button for screen readers too.
document.querySelectorAll("pre > code, .table-wrapper").forEach((box) => { box.tabIndex = 0; });
document.querySelectorAll("label[for=mdbook-sidebar-toggle-anchor]").forEach((label) => label.setAttribute("role", "button"));
// The search box has a placeholder and no name.
document.getElementById("mdbook-searchbar")?.setAttribute("aria-label", "Search this book");
