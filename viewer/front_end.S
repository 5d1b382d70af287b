/* The files of the front end, as bytes of the program (viewer/assets.cpp). */
    .section .rodata
    .macro embed name, file
    .global \name\()_begin
    .global \name\()_end
\name\()_begin:
    .incbin "\file"
\name\()_end:
    .byte 0
    .endm

    embed skyquilt_index_html, "index.html"
    embed skyquilt_app_js, "app.js"
    embed skyquilt_app_css, "app.css"
    embed skyquilt_licences_txt, "licences.txt"

    .section .note.GNU-stack,"",%progbits
