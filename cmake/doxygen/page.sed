# Filter for pages. Links to files that are no API pages become their text: a mark (@) keeps the others. Doxygen links
# names of headers itself, but not in code, and prints code in headings as markup.
s:\]\(((architecture|glossary|library)\.md|#|https?\:):](@\1:g
s:\[([^]]*)\]\([^@)][^)]*\):\1:g
s:\]\(@:](:g
s:`([a-z_0-9]+/[a-z_0-9/]+\.h)`:\1:g
/^#/s:`::g
