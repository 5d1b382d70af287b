/* The files of the front end, as bytes of the program (viewer/assets.cpp). */
    .section .rodata
    .macro embed name, file
    .global \name\()Begin
    .global \name\()End
\name\()Begin:
    .incbin "\file"
\name\()End:
    .byte 0
    .endm

    embed kSkyquiltIndexHtml, "index.html"
    embed kSkyquiltAppJs, "app.js"
    embed kSkyquiltAppCss, "app.css"
    embed kSkyquiltLicencesTxt, "licences.txt"
    embed kSkyquiltTourHtml, "tour.html"
    embed kSkyquiltTourJs, "tour.js"
    embed kSkyquiltTourCss, "tour.css"

    .section .note.GNU-stack,"",%progbits
