# Filter for headers. The first comment describes the file. A line that begins with the name of a contract tag and two
# spaces begins a titled paragraph; cmake/doxygen.cmake defines a command per tag.
1s:^///:/// @header:
s:^( *///) (Space|Exact|Range|Cost|Errors|Source)(  +|$):\1 @\2 :
