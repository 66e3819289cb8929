var ws=class extends Error{};async function Th(i){if(i.ok)return i;let t=`the server answered ${i.status}`;try{let e=await i.json();e.error&&(t=e.error)}catch{}throw new ws(t)}async function Rh(i,t){let e;try{e=await fetch(i,t)}catch{throw new ws("the studio does not answer; was it ended in the terminal?")}return Th(e)}var mn=async(i,t)=>await(await Rh(i,t)).json(),ha=()=>mn("v1/state"),pf=i=>mn(`v1/files?path=${encodeURIComponent(i)}`),ua=i=>mn(`v1/text?path=${encodeURIComponent(i)}`),mf=i=>`v1/picture?path=${encodeURIComponent(i)}`,gf=(i,t)=>mn(`v1/text?path=${encodeURIComponent(i)}`,{method:"POST",headers:{"content-type":"text/plain"},body:t}),_f=i=>Rh("v1/check",{method:"POST",headers:{"content-type":"text/plain"},body:i}).then(()=>"",t=>t.message),yf=i=>mn(`v1/job?path=${encodeURIComponent(i)}`),xf=()=>mn("v1/examples"),vf=i=>mn(`v1/examples?name=${encodeURIComponent(i)}`,{method:"POST"}),bf=()=>mn("v1/schema"),da=()=>mn("v1/profiles"),Kr=()=>mn("v1/jobs"),jr=()=>mn("v1/history"),Sf=async()=>(await mn("v1/drafts")).drafts,Mf=i=>mn(`v1/jobs/${i}/layers`),In=i=>mn(`v1/jobs/${i}/result`);async function Ch(i){let t=JSON.stringify(i);await Rh("v1/drafts",{method:"PUT",headers:{"content-type":"application/json"},body:t,keepalive:t.length<2e4})}function wf(i){return mn("v1/jobs",{method:"POST",headers:{"content-type":"application/json"},body:JSON.stringify(i)})}async function fa(i){await Th(await fetch(`v1/jobs/${i}`,{method:"DELETE"}))}async function cn(i,t){return(await Th(await fetch(i,t?{signal:t}:{}))).arrayBuffer()}function Af(i,t){return new Promise((e,n)=>{let s=new EventSource(`v1/jobs/${i}/events`);s.onmessage=r=>{let o=JSON.parse(r.data);t(o),(o.phase==="done"||o.phase==="failed"||o.phase==="cancelled")&&(s.close(),e(o))},s.onerror=()=>{s.readyState===EventSource.CLOSED&&n(new ws("the studio does not answer; was it ended in the terminal?"))}})}function Ef(i,t){return new Promise((e,n)=>{let s=new XMLHttpRequest;s.open("POST",`v1/uploads?name=${encodeURIComponent(i.name)}`),s.responseType="json",s.upload.onprogress=r=>t(r.loaded/Math.max(r.total,1)),s.onload=()=>{let r=s.response;s.status===200&&r?.path?e({path:r.path}):n(new ws(r?.error??`the server answered ${s.status}`))},s.onerror=()=>n(new ws("the upload broke off; drop the file again")),s.send(i)})}var Zi=[["role","Role"],["speed","Speed, mm/s"],["width","Width, mm"],["angle","Angle in the plane"],["flow","Flow, mm³/s"],["height","Height, mm"],["time","Layer time, s"],["seam","Seams"],["load","Angle off the load"],["reserve","Reserve, times the load"]],As=[184,191,196],ma=[208,31,60],Ji=[[214,93,32],[240,163,74],[197,60,103],[156,79,160],[42,116,178],[27,79,138],[86,178,171],[30,30,30],[110,150,50],[150,150,150],[125,125,125],[185,185,150],[160,160,110],[16,44,84],[120,130,140]],ga=[[206,0,160],[0,146,70]],pa=[[68,1,84],[72,40,120],[62,74,137],[49,104,142],[38,130,142],[31,158,137],[53,183,121],[110,206,88],[253,231,37]];function Ln(i){let t=Math.min(Math.max(i,0),1)*(pa.length-1),e=Math.min(Math.floor(t),pa.length-2),[n,s]=[pa[e],pa[e+1]];return[0,1,2].map(r=>Math.round(n[r]+(s[r]-n[r])*(t-e)))}function _a(i){let t=e=>Math.round(140+105*Math.cos(2*Math.PI*(i-e)));return[t(0),t(1/3),t(2/3)]}var wi=i=>`rgb(${i[0]} ${i[1]} ${i[2]})`;function ya(i){let t=new Uint8Array(1024);for(let e=0;e<256;e++)t.set([...i(e/255),255],4*e);return t}function Ki(i){return`linear-gradient(to right, ${Array.from({length:17},(e,n)=>wi(i(n/16))).join(", ")})`}var Ne=6,Tf=4,qe=Ji.length-1,Ph=128,Rf=255,[Ih,Lh]=[80,20],xa=class{constructor(t){this.index=t;this.first=new Int32Array(t.layers.length+1),t.layers.forEach((e,n)=>this.first[n+1]=this.first[n]+e.records),this.words=new Uint16Array(Ne*this.first[t.layers.length]);for(let e=0;e<this.words.length;e+=Ne)this.words[e+3]=this.start,this.words[e+5]=65535}index;first;words;taken=0;get travel(){return qe}get start(){return qe+1}take(t,e,n){let s=new Uint16Array(n),[r,o]=[this.first[t],this.first[e+1]];if(s.length!==Tf*(o-r))throw new Error(`layers ${t} to ${e} have another length than the index says`);for(let a=t;a<=e;a++)for(let l=this.first[a];l<this.first[a+1];l++){let[c,h]=[Tf*(l-r),Ne*l];this.words[h]=s[c],this.words[h+1]=s[c+1],this.words[h+2]=s[c+2],this.words[h+3]=s[c+3],this.words[h+4]=a}t<=this.taken&&(this.taken=Math.max(this.taken,e+1))}keep(t){let[e,n]=[t.index,this.index];if(e.step_mm!==n.step_mm||e.origin_mm.some((r,o)=>r!==n.origin_mm[o])||e.speeds_mm_s.some((r,o)=>r!==n.speeds_mm_s[o]))return 0;let s=0;for(;s<t.taken&&s<n.layers.length&&t.first[s+1]===this.first[s+1];)s++;return this.words.set(t.words.subarray(0,Ne*this.first[s])),this.taken=s}takeValues(t,e,n,s){let r=new Uint8Array(s),[o,a]=[this.first[e],this.first[n+1]];if(r.length!==a-o)throw new Error(`${t} of layers ${e} to ${n} have another length than the index says`);let[l,c]=t==="angles"?[65280,0]:[255,8];for(let h=o;h<a;h++){let u=Ne*h+5;this.words[u]=this.words[u]&l|r[h-o]<<c}}point(t){let e=Ne*t,{origin_mm:n,step_mm:s}=this.index;return[n[0]+s*this.words[e],n[1]+s*this.words[e+1]]}bead(t){let e=Ne*t,[n,s]=[this.point(t-1),this.point(t)],[r,o]=[s[0]-n[0],s[1]-n[1]],a=this.words[e+4],l=this.words[e+2]*.001,c=this.words[e+3]&Ph-1,h=(this.words[e+3]&Ph)!==0,[u,d]=[this.words[e+5]&255,this.words[e+5]>>8],f=this.index.speeds_mm_s[this.words[e+3]>>8]??0,p=this.index.layers[a].height_mm,_=Math.atan2(o,r)*180/Math.PI;_<0&&(_+=180),_>=179.95&&(_=0);let m=p*(l-p*(1-Math.PI/4));return{record:t,layer:a,kind:c,a:n,b:s,width_mm:l,speed_mm_s:f,length_mm:Math.hypot(r,o),angle_deg:_,flow_mm3_s:Math.max(m,0)*f,isSeam:h,off_deg:u===Rf?null:u/2,reserve:d===Rf?null:2**((d-Ih)/Lh)}}under(t,e,n,s,r,o){let{origin_mm:a,step_mm:l}=this.index,[c,h]=[(e-a[0])/l,(n-a[1])/l],u=Math.max(this.first[t]+1,s);for(let d=Math.min(this.first[t+1]-1,r);d>=u;d--){let f=Ne*d,p=this.words[f+3]&Ph-1;if(p>=this.travel||!o(p))continue;let _=this.words[f+2]*5e-4/l,[m,g,y,b]=[this.words[f-Ne],this.words[f-Ne+1],this.words[f],this.words[f+1]];if(c<Math.min(m,y)-_||c>Math.max(m,y)+_||h<Math.min(g,b)-_||h>Math.max(g,b)+_)continue;let[v,M]=[y-m,b-g],A=Math.min(Math.max(((c-m)*v+(h-g)*M)/Math.max(v*v+M*M,1e-9),0),1);if(Math.hypot(c-m-A*v,h-g-A*M)<=_)return d}return-1}};function S(i,t={},...e){let n=document.createElement(i);Cf(n,t);for(let s of e)s&&n.append(s);return n}function je(i,t={},...e){let n=document.createElementNS("http://www.w3.org/2000/svg",i);Cf(n,t);for(let s of e)s&&n.append(s);return n}function Cf(i,t){for(let[e,n]of Object.entries(t))n===void 0||n===!1||(typeof n=="function"?i.addEventListener(e.slice(2),n):i.setAttribute(e,n===!0?"":String(n)))}function Qr(i){let t=i.trim().replace("−","-").replace(",",".");return!/^[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?$/i.test(t)||!Number.isFinite(Number(t))?null:t.replace(/^([+-]?)0+(?=\d)/,"$1").replace(/^([+-]?)\./,"$10.").replace(/\.(?=e|$)/i,".0")}function Es(i,t,e=i){if(e.nextElementSibling?.className==="wrong"&&e.nextElementSibling.remove(),i.dataset.wrong=t,!t){i.removeAttribute("aria-invalid");return}i.setAttribute("aria-invalid","true"),e.after(S("span",{class:"wrong",role:"alert"},t))}function An(i,t,e){let n=r=>{let o=t.isOptional&&s.value.trim()==="",a=o?NaN:Number(Qr(s.value)??NaN),l=o||(t.isPositive?a>0:Number.isFinite(a));if(!l&&t.isView){r||(s.value=s.dataset.shown??"");return}Es(s,l?"":`should be a number${t.isPositive?" above 0":""}, as 2.5`),l&&!r&&ti(s,o?"":a),l&&(t.isLive||!r)&&e(a)},s=S("input",{type:"text",inputmode:"decimal",...i,onchange:()=>n(!1),oninput:()=>n(!0)});return s.dataset.shown=s.value,s}function ti(i,t,e=i){i.dataset.wrong&&i.dataset.shown===String(t)||(i.value=i.dataset.shown=String(t),Es(i,"",e))}var va=i=>Number(Qr(i.value)??NaN);function Yn(i){let{file:t,line:e,layer:n,z_mm:s,point_mm:r}=i.place??{},o=s===void 0?"":`z = ${nt(s,2)} mm`,a=[t,e&&`line ${e}`,n?`layer ${n}${o&&` at ${o}`}`:o,r&&`(${r.map(l=>nt(l,2)).join(", ")})`].filter(l=>l).join(", ");return S("p",{class:"warning"},`${a&&`${a}: `}${i.text}${i.remedy?` – ${i.remedy}`:""}`)}function Tt(i){let t=document.getElementById(i);if(!t)throw new Error(`the page has no #${i}`);return t}function ba(i,t,e,n,s,r){let o=0,a=c=>{i.textContent=c?"⏸":"▶",i.setAttribute("aria-label",c?"Pause":n)},l=()=>{cancelAnimationFrame(o),o=0,a(!1)};return a(!1),()=>{if(o){l();return}t.value===t.max&&(t.value=s()),a(!0);let c=Number(t.max),h=Number(t.value),u=performance.now(),d=f=>{h+=(f-u)/(1e3*e)*c,u=f,t.value=String(Math.min(Math.round(h),c)),r(),h>=c||!t.isConnected?l():o=requestAnimationFrame(d)};o=requestAnimationFrame(d)}}function nt(i,t){return i.toFixed(t)}function ji(i){if(i<90)return`${nt(i,1)} s`;let t=Math.round(i/60);return t<90?`${t} min`:`${Math.floor(t/60)} h ${t%60} min`}function Pf(i){return i<1e3?`${i} B`:i<1e6?`${nt(i/1e3,1)} kB`:i<1e9?`${nt(i/1e6,1)} MB`:`${nt(i/1e9,2)} GB`}var L0={job:"job",mesh:"mesh",outline:"outline",photo:"photograph",scan:"scan",program:"G-code",other:""},D0=[[/\.bgcode$/i,"binary G-code: have it written as text"]];async function If(i,t){let{roots:e}=await ha(),n=t?.replace(/[/\\][^/\\]*$/,"")??e[0]??"";return new Promise(s=>{let r=S("div",{class:"files"}),o=S("p",{class:"note","aria-live":"polite"}),a=h=>{i.onclose=null,i.open&&i.close(),s(h)},l=async h=>{try{let u=await pf(h);o.textContent=u.path;let d=[];u.parent&&d.push(S("button",{type:"button",onclick:()=>{l(u.parent)}},S("span",{},".."),S("span",{},"up")));let f=u.files.filter(p=>p.kind==="photo"||p.kind==="scan"||!p.name.includes(".")).length;f>1&&d.push(S("button",{type:"button",id:"open-folder",onclick:()=>a({path:u.path,kind:"scan"})},S("span",{},"Open this folder as a scan"),S("span",{},`${f} slices`)));for(let p of u.folders)d.push(S("button",{type:"button",onclick:()=>{l(p.path)}},S("span",{},`${p.name}/`),S("span",{},"folder")));for(let p of u.files){let _=()=>a({path:p.path,kind:p.kind}),m=D0.find(([g])=>g.test(p.name))?.[1];d.push(S("button",{type:"button",disabled:p.kind==="other"||!!m,onclick:_},S("span",{},p.name),S("span",{},`${m??L0[p.kind]} ${Pf(p.bytes)}`)))}u.left_out>0&&d.push(S("p",{class:"note"},`${u.left_out} more are not listed`)),r.replaceChildren(...d),r.querySelector("button:not(:disabled)")?.focus()}catch(u){o.textContent=u.message}},c=e.length>1?S("div",{class:"row"},...e.map(h=>S("button",{type:"button",onclick:()=>{l(h)}},h))):null;i.replaceChildren(S("h2",{},"Open a file of this computer"),...c?[c]:[],o,r,S("p",{},S("button",{type:"button",onclick:()=>a(null)},"Close"))),i.onclose=()=>a(null),i.showModal(),l(n)})}var to=new Map,Sa=Promise.resolve();function Dh(i){let t=to.has(i.path);if(to.set(i.path,i),t)return Sa;let e=()=>{let n=to.get(i.path);return to.delete(i.path),Ch(n)};return Sa=Sa.then(e,e)}var Ma=i=>Dh({path:i,kind:"other",text:"",from:""}),wa=()=>Sa.catch(()=>{}).then(Sf);addEventListener("pagehide",()=>{for(let i of to.values())Ch(i)});var N0={read:"Reading",slice:"Shape",guide:"Stress",fill:"Walls and fill",support:"Supports",order:"Ordering",write:"Writing",strength:"Strength test"},Lf={view:"program",shape:"shape",stress:"stress",orient:"directions",supports:"supports",plan:"plan",strength:"strength test"},F0=500;function Nh(i){return i.phase==="waiting"?`Waits for ${i.ahead} other${i.ahead===1?"":"s"}`:`${N0[i.stage??""]??"Starting"}${i.total>0?` ${i.done} of ${i.total}`:""}`}async function Df(i,t,e){let n=new Map,s=S("table",{id:"queue"},S("tr",{},...["What","File","How far","Time",""].map(l=>S("th",{scope:"col"},l||S("span",{class:"sr"},"Cancel"))))),r=S("p",{class:"error",role:"alert",hidden:!0}),o=l=>{r.textContent=l.message,r.hidden=!1},a=l=>{let c=S("button",{type:"button","data-cancel":l.id,"aria-label":`Cancel ${Lf[l.kind]} of ${l.title}`,onclick:()=>{c.disabled=!0,fa(l.id).catch(f=>{c.disabled=!1,o(f)})}},"Cancel"),[h,u]=[S("td"),S("td",{class:"n"})],d=S("tr",{"data-run":l.id},S("td",{},Lf[l.kind]),S("td",{},l.title),h,u,S("td",{},c));return s.append(d),n.set(l.id,{row:d,far:h,time:u}),n.get(l.id)};for(;t();){try{let l=(await Kr()).jobs.filter(u=>u.phase==="waiting"||u.phase==="running");for(let u of l){let{far:d,time:f}=n.get(u.id)??a(u);d.textContent=Nh(u),f.textContent=u.phase==="waiting"?"–":`${nt(u.elapsed_s,1)} s`}let c=[...n.keys()].filter(u=>!l.some(d=>d.id===u));for(let u of c)n.get(u).row.remove(),n.delete(u);let h=n.size===0;h!==(s.parentElement===null)&&i.replaceChildren(...h?[]:[S("h2",{},"Worked on and waiting"),s,r]),c.length>0&&await e()}catch(l){o(l),i.replaceChildren(r);return}await new Promise(l=>setTimeout(l,F0))}}var Xs=(i,t,e)=>i==null?"–":`${nt(i,t)} ${e}`,Nf=(i,t)=>i&&t?`${nt(100*t/i,1)} %`:"",Aa=i=>i.input?.split(/[/\\]/).pop()??i.name,Ff=(i,t)=>i.card&&t.card?i.card===t.card:i.card_source===t.card_source;function Uf(i,t){let e=t.peak_load_n/i.peak_load_n;if(!Ff(i,t))return{nominal:e,low:t.low_n/i.high_n,high:t.high_n/i.low_n};let n=[e,...Object.entries(t.corners).flatMap(([r,o])=>i.corners[r]?[o/i.corners[r]]:[])],s=Math.max(i.grid_share,t.grid_share);return{nominal:e,low:Math.min(...n)*(1-s),high:Math.max(...n)*(1+s)}}function U0(i,t){let[e,n]=[i.strength,t.strength],s=(c,h,u,d)=>[c,Xs(h(i),u,d),Xs(h(t),u,d),Nf(h(i),h(t))],r=c=>c?`${nt(c.peak_load_n,0)} N (${nt(c.low_n,0)} to ${nt(c.high_n,0)})`:"–",o=c=>c?`${c.card??""} tier ${c.card_tier}`:"–",a=[s("Mass",c=>c.mass_g,2,"g"),["Printing time",i.time_s===null?"–":ji(i.time_s),t.time_s===null?"–":ji(t.time_s),Nf(i.time_s,t.time_s)],s("Layers",c=>c.layers,0,"")];if(!e&&!n)return a;let l=e&&n?Uf(e,n):null;return a.push(["Breaks at",r(e),r(n),l?`${nt(100*l.nominal,1)} % (${nt(100*l.low,1)} to ${nt(100*l.high,1)})`:""],s("Load of the job",c=>c.strength?.job_load_n,0,"N"),s("First bead fails at",c=>c.strength?.first_n,0,"N"),s("Stiffness",c=>c.strength?.stiffness_n_per_mm,0,"N/mm"),s("Load over mass",c=>c.strength?.load_per_gram_n_g,1,"N/g"),s(`Breaks at, for ${Xs(i.mass_g,2,"g")} of each${Of(i,t)?"":`, the second taken ${nt(i.mass_g/t.mass_g,2)} times as heavy`}`,c=>c.strength&&i.mass_g?c.strength.load_per_gram_n_g*i.mass_g:null,0,"N"),["Fails mostly",e?.mode??"–",n?.mode??"–",""],["Weakest at",e?.weakest.words??"–",n?.weakest.words??"–",""],["Card",o(e),o(n),""]),a}var O0=i=>i.input===null||i.input.endsWith(".toml"),Of=(i,t)=>!i.mass_g||!t.mass_g||Math.abs(i.mass_g/t.mass_g-1)<B0,B0=.01;async function Bf(i,t,e,n){let{runs:s}=await jr(),r=typeof t=="number"?[...s.keys()].filter(f=>s[f].strength).slice(0,t):t.map(f=>s.findIndex(p=>p.name===f)).filter(f=>f>=0),o=S("div",{id:"compared",role:"status"}),a=(f,p)=>{let _=S("input",{type:"checkbox",checked:r.includes(p),"aria-label":`Compare ${Aa(f)} of ${Ea(f)}`,onchange:()=>{_.checked?r.push(p):r.splice(r.indexOf(p),1),r.length>2&&(l[r.shift()].checked=!1),c()}});return _},l=[],c=()=>{if(r.length<2){o.replaceChildren(S("p",{class:"note"},s.length>1?"Mark two runs to see them side by side.":"Two runs can be seen side by side."));return}let[f,p]=[...r].sort((b,v)=>b-v).map(b=>s[b]),_=b=>S("th",{scope:"col"},`${Aa(b)}, ${Ea(b)}`),m=p.strength&&f.strength?Uf(p.strength,f.strength):null,g=(b,v,M,A)=>!O0(b)||Of(b,v)?null:S("button",{type:"button",id:A,onclick:()=>{i.close(),e(b,v.mass_g,v.name)}},`Plan the ${M} anew at ${Xs(v.mass_g,2,"g")} and test it`),y=[g(f,p,"second","equal-second"),g(p,f,"first","equal-first")].filter(b=>b!==null);o.replaceChildren(S("h2",{},"Side by side"),S("table",{},S("tr",{},S("td"),_(p),_(f),S("th",{scope:"col"},"second over first")),...U0(p,f).map(([b,...v])=>S("tr",{},S("th",{scope:"row"},b),...v.map(M=>S("td",{},M))))),...m&&!Ff(p.strength,f.strength)?[S("p",{class:"note"},`The materials differ (${p.strength.card??p.strength.card_source} and ${f.strength.card??f.strength.card_source}): what is not known of one is not known of the other, so the interval goes from the low load of the second over the high one of the first to the reverse.`)]:[],...m?[S("p",{id:"decided"},m.low>1?"The second carries more.":m.high<1?"The first carries more.":"Which one carries more is not decided: the interval holds 100 %.")]:[],...y.length>0?[S("div",{class:"row"},...y)]:[])},h=S("div"),u=()=>{l=s.map(a),h.replaceChildren(s.length===0?S("p",{class:"note"},"None yet: plans and strength tests are listed here, and stay when the studio is ended."):S("div",{class:"files"},S("table",{id:"all-runs"},S("tr",{},...["","When","What","File","Mass","Time","Breaks at","Open"].map(f=>S("th",{scope:"col"},f||S("span",{class:"sr"},"Compare")))),...s.map((f,p)=>S("tr",{},S("td",{},l[p]),S("td",{},Ea(f)),S("td",{},f.kind==="plan"?"plan":"strength test"),S("td",{title:f.name},Aa(f)),S("td",{class:"n"},Xs(f.mass_g,2,"g")),S("td",{class:"n"},f.time_s===null?"–":ji(f.time_s)),S("td",{class:"n"},Xs(f.strength?.peak_load_n,0,"N")),S("td",{},S("button",{type:"button","data-open":f.name,"aria-label":`Open ${Aa(f)} of ${Ea(f)}`,onclick:()=>{i.close(),n(f)}},"Open"))))))),c()};u();let d=S("div");i.replaceChildren(d,S("h2",{},"Runs in this folder"),h,o,S("p",{},S("button",{type:"button",onclick:()=>i.close()},"Close"))),i.showModal(),Df(d,()=>i.open&&d.isConnected,async()=>{let f=s[0];({runs:s}=await jr());let p=f?s.findIndex(_=>_.at_s===f.at_s&&_.name===f.name):s.length;p!==0&&(r=p<0?[]:r.map(_=>_+p).filter(_=>_<s.length),u())})}var Ea=i=>new Date(1e3*i.at_s).toLocaleString([],{dateStyle:"short",timeStyle:"short"});function Fh(i,t,e=1){let n=i.speeds_mm_s;switch(t){case"speed":return n.length>0?[Math.min(...n),Math.max(...n)]:[0,1];case"width":return i.widths_mm;case"flow":return[0,i.flow_mm3_s];case"height":return[0,i.layers[i.layers.length-1].z_mm];case"time":{let s=i.layers.map(r=>r.time_s??0);return[Math.min(...s),Math.max(...s)]}case"load":return[0,90];case"reserve":return[-Math.log2(10*e),-Math.log2(e)];case"role":case"angle":case"seam":return[0,180]}}function qs(i){let t=S("span",{class:"swatch"});return t.style.background=wi(i),t}var kf=i=>i>400?"over 400 ×":`${nt(i,i<1?2:i<10?1:0)} ×`;function zf(i,t,e=1){if(t==="role")return i.shares.flatMap((c,h)=>c.beads>0?[S("div",{},qs(Ji[h]),i.classes[h])]:[]);if(t==="seam"){let c=i.layers.reduce((h,u)=>h+u.seams,0);return[S("div",{},qs(ma),`where a closed wall begins (${c})`),S("div",{},qs(As),"other beads")]}let n=S("div",{class:"ramp"});n.style.background=Ki(t==="angle"?_a:Ln);let s=t==="angle"||t==="load",r=c=>nt(c,t==="width"?2:s?0:1)+(s?"°":""),o=t==="reserve"?[10,Math.sqrt(10),1].map(c=>kf(c*e)):Fh(i,t).map(r),a=t==="load"?"no direction asked for":t==="reserve"?"no part, or near fixtures and loads":null,l=Zi.find(([c])=>c===t)[1];return[S("div",{},l),n,S("div",{class:"ends"},...o.map(c=>S("span",{},c))),...a?[S("div",{},qs(As),a)]:[]]}function Vf(i,t){return[i.classes[t.kind],`layer ${t.layer+1}`,`${nt(t.width_mm,2)} mm wide`,`${nt(i.layers[t.layer].height_mm,2)} mm high`,...t.isSeam?["seam"]:[],...t.off_deg===null?[]:[`${nt(t.off_deg,1)}° off the load`],...t.reserve===null?[]:[`fails at ${kf(t.reserve)} the load`],`${nt(t.speed_mm_s,1)} mm/s`,`${nt(t.flow_mm3_s,1)} mm³/s`,`${nt(t.length_mm,2)} mm long`,`${nt(t.angle_deg,0)}°`,`at (${nt(t.b[0],1)}, ${nt(t.b[1],1)})`].join(" · ")}function Gf(i,t){let e=i?.layers[t];return e?`${t+1}
${nt(e.z_mm,2)} mm`:""}var k0={a:(i,t)=>t?i.pan(-.1,0):i.turn(-15,0),d:(i,t)=>t?i.pan(.1,0):i.turn(15,0),w:(i,t)=>t?i.pan(0,.1):i.turn(0,15),s:(i,t)=>t?i.pan(0,-.1):i.turn(0,-15),"+":i=>i.zoom(.8),"=":i=>i.zoom(.8),"-":i=>i.zoom(1.25),1:i=>i.view("top"),2:i=>i.view("front"),3:i=>i.view("side"),4:i=>i.view("oblique")};function Hf(i,t){let e=k0[t.key.toLowerCase()];return e?.(i,t.shiftKey),e!==void 0}var Wf=["Upper left","Upper right","Lower right","Lower left"],z0=11,V0={ArrowLeft:[-1,0],ArrowRight:[1,0],ArrowUp:[0,-1],ArrowDown:[0,1]},Ta=class{constructor(t,e){this.moved=t;this.failed=e;this.rings=Wf.map((n,s)=>this.ring(s)),this.drawing=je("svg",{},this.outline,...this.rings),this.element.append(this.image,this.drawing),this.image.addEventListener("load",()=>{this.size=[this.image.naturalWidth,this.image.naturalHeight],this.draw()}),this.image.addEventListener("error",()=>this.failed("The photograph cannot be shown here; it is read from its file all the same.")),new ResizeObserver(()=>this.draw()).observe(this.element)}moved;failed;element=S("div",{id:"photo",hidden:!0});size=null;address="";stated=null;corners=[];image=S("img",{alt:"The photograph of the board"});outline=je("polygon",{});rings;drawing;show(t,e){this.stated=e,t!==this.address&&(this.size=null,this.address=t,this.image.src=t),this.draw()}draw(){if(this.drawing.toggleAttribute("hidden",this.size===null),!this.size)return;let[t,e]=this.size;this.corners=this.stated??[[0,0],[t,0],[t,e],[0,e]],this.drawing.setAttribute("viewBox",`0 0 ${t} ${e}`),this.outline.setAttribute("points",this.corners.map(s=>s.join(",")).join(" "));let n=this.drawing.getScreenCTM()?.a??1;this.rings.forEach((s,r)=>{let[o,a]=this.corners[r];s.setAttribute("cx",String(o)),s.setAttribute("cy",String(a)),s.setAttribute("r",String(z0/Math.max(n,1e-6))),s.setAttribute("aria-label",`${Wf[r]} corner of the board: ${nt(o,1)}, ${nt(a,1)} px`)})}put(t,[e,n]){if(!this.size)return;let s=(r,o)=>Number(nt(Math.min(Math.max(r,0),o),1));this.stated=this.corners.map((r,o)=>o===t?[s(e,this.size[0]),s(n,this.size[1])]:r),this.draw()}ring(t){let e=je("circle",{class:"corner",tabindex:0,role:"button","data-corner":t}),n=null,s=o=>{let a=new DOMPoint(o.clientX,o.clientY).matrixTransform(this.drawing.getScreenCTM().inverse());return[a.x,a.y]};e.addEventListener("pointerdown",o=>{n={at:s(o),corner:this.corners[t]},e.setPointerCapture(o.pointerId),e.focus(),o.preventDefault()}),e.addEventListener("pointermove",o=>{if(!n)return;let a=s(o);this.put(t,[n.corner[0]+a[0]-n.at[0],n.corner[1]+a[1]-n.at[1]])});let r=()=>{n&&this.stated&&this.moved(this.stated),n=null};return e.addEventListener("pointerup",r),e.addEventListener("pointercancel",r),e.addEventListener("keydown",o=>{let a=V0[o.key];if(!a)return;let l=o.shiftKey?10:1;this.put(t,[this.corners[t][0]+l*a[0],this.corners[t][1]+l*a[1]]),this.stated&&this.moved(this.stated),o.preventDefault(),o.stopPropagation()}),e}};function Xf(i,t){let e=0;for(let n=t;n<i.length;){let s=i[n];if(s==='"'||s==="'"){let r=s.repeat(3);if(i.startsWith(r,n)){let o=i.indexOf(r,n+3);n=o<0?i.length:o+3;continue}for(n++;n<i.length&&i[n]!==s&&i[n]!==`
`;)n+=s==='"'&&i[n]==="\\"?2:1;n++;continue}if(s==="["||s==="{")e++;else if(s==="]"||s==="}")e--;else if(s==="#"){if(e===0)return Uh(i,t,n);let r=i.indexOf(`
`,n);n=r<0?i.length:r;continue}else if(s===`
`&&e<=0)return Uh(i,t,n);n++}return Uh(i,t,i.length)}function Uh(i,t,e){for(;e>t&&/\s/.test(i[e-1]);)e--;return e}var $f=i=>i.split(".").map(t=>t.trim().replace(/^(["'])(.*)\1$/,"$2")).join(".");function Ai(i){return qf(i).found}var Oh={text:"",found:[],headers:[]};function qf(i){if(i===Oh.text)return Oh;let t=[],e=[],n="",s=!1;for(let r=0;r<i.length;){let o=i.indexOf(`
`,r)<0?i.length:i.indexOf(`
`,r),a=i.slice(r,o),l=a.match(/^\s*(\[\[?)\s*([^\]]+?)\s*\]\]?\s*(#.*)?$/),c=a.match(/^(\s*([A-Za-z0-9_.\-"' ]+?)\s*=\s*)\S/);if(l)n=$f(l[2]),s=l[1]==="[[",e.push({table:n,isList:s,from:r,to:Math.min(o+1,i.length)});else if(c){let h=r+c[1].length,u=Xf(i,h),d=$f(c[2]).split("."),f=d.pop();t.push({table:[n,...d].filter(_=>_).join("."),isList:s,key:f,from:h,to:u});let p=i.indexOf(`
`,u);r=p<0?i.length:p+1;continue}r=o+1}return Oh={text:i,found:t,headers:e}}function Qi(i,...t){let{found:e,headers:n}=qf(i),s=[];return n.forEach((r,o)=>{if(!r.isList||!t.includes(r.table))return;let a=n[o+1],l=e.filter(d=>d.from>=r.to&&d.from<(a?.from??i.length)),c=l[l.length-1],h=c?i.indexOf(`
`,c.to):r.to-1,u=l.every(d=>d.table===r.table)&&!a?.table.startsWith(`${r.table}.`);s.push({table:r.table,from:r.from,to:h<0?i.length:h+1,keys:new Map(l.filter(d=>d.table===r.table).map(d=>[d.key,d])),isPlain:u})}),s}function Ys(i,t,e){let n=i.slice(0,t),s=n===""||n.endsWith(`

`)?"":n.endsWith(`
`)?`
`:`

`,r=i.slice(t);return`${n}${s}${e}${r===""||r.startsWith(`
`)?"":`
`}${r}`}function Bh(i,t){let e=i.slice(0,t.from).endsWith(`

`)?t.from-1:t.from;return i.slice(0,e)+i.slice(t.to)}function eo(i,t,e,n){let s=t.keys.get(e);if(s&&n!==null)return i.slice(0,s.from)+n+i.slice(s.to);if(s){let r=i.lastIndexOf(`
`,s.from)+1,o=i.indexOf(`
`,s.to);return i.slice(0,r)+(o<0?"":i.slice(o+1))}return n===null?i:`${i.slice(0,t.to)}${i.slice(0,t.to).endsWith(`
`)?"":`
`}${e} = ${n}
${i.slice(t.to)}`}function Qe(i){let t=0,e=()=>{for(;;){for(;/\s/.test(i[t]??"");)t++;if(i[t]!=="#")return;let o=i.indexOf(`
`,t);t=o<0?i.length:o}};class n extends Error{}let s=o=>{if(e(),i[t]!==o)throw new n;t++},r=()=>{e();let o=i[t];if(o==='"'||o==="'"){let c=Xf(i,t),h=o==='"'?/^"(?:[^"\\\n]|\\.)*"/.exec(i.slice(t,c)):/^'[^'\n]*'/.exec(i.slice(t,c));if(!h)throw new n;return t+=h[0].length,o==='"'?JSON.parse(h[0]):h[0].slice(1,-1)}if(o==="["){t++;let c=[];for(e();i[t]!=="]";e())if(c.push(r()),e(),i[t]===",")t++;else if(i[t]!=="]")throw new n;return t++,c}if(o==="{"){t++;let c={};for(e();i[t]!=="}";e()){let h=/^[A-Za-z0-9_-]+/.exec(i.slice(t))?.[0];if(!h)throw new n;if(t+=h.length,s("="),c[h]=r(),e(),i[t]===",")t++;else if(i[t]!=="}")throw new n}return t++,c}let a=/^[A-Za-z0-9_+.-]+/.exec(i.slice(t))?.[0];if(!a)throw new n;if(t+=a.length,a==="true"||a==="false")return a==="true";let l=Number(a.replaceAll("_",""));if(Number.isNaN(l))throw new n;return l};try{let o=r();return e(),t===i.length?o:void 0}catch{return}}function re(i,t,e){let n=Ai(i).find(s=>!s.isList&&s.table===t&&s.key===e);return n?i.slice(n.from,n.to):null}function ge(i,t,e,n){let s=Ai(i),r=s.find(h=>!h.isList&&h.table===t&&h.key===e);if(r){if(n!==null)return i.slice(0,r.from)+n+i.slice(r.to);let h=i.lastIndexOf(`
`,r.from)+1,u=i.indexOf(`
`,r.to);return i.slice(0,h)+(u<0?"":i.slice(u+1))}if(n===null)return i;let o=`${e} = ${n}
`,a=new RegExp(`^[ \\t]*\\[\\s*${t.replaceAll(".","\\s*\\.\\s*")}\\s*\\][^\\n]*(\\n|$)`,"m").exec(i);if(!a)return`${i}${i===""||i.endsWith(`
`)?"":`
`}${i===""?"":`
`}[${t}]
${o}`;let l=a.index+a[0].length;for(let h of s){if(h.from<l||h.isList||h.table!==t)continue;let u=i.indexOf(`
`,h.to);if(/^\s*\[/m.test(i.slice(a.index+a[0].length,h.from).replace(/^[^\n]*=[^\n]*$/gm,"")))break;l=u<0?i.length:u+1}let c=i.slice(0,l);return`${c}${c.endsWith(`
`)?"":`
`}${o}${i.slice(l)}`}function Yf(i){let t=[i.type??[]].flat();return i.enum||t.some(e=>["number","integer","boolean"].includes(e))?!0:t.includes("array")?i.items?.type==="number"||i.items?.type==="integer":t.includes("string")}function Jf(i){return Array.isArray(i)?`[${i.map(Jf).join(", ")}]`:JSON.stringify(i)}function G0(i,t){let e=[i.type??[]].flat(),n=t.trim();if(i.enum)return i.enum.includes(n)?JSON.stringify(n):null;if(e.includes("array")&&/^\[/.test(n)){let r=n.replace(/^\[|\]$/g,"").split(",").filter(o=>o.trim()).map(Qr);return r.every(o=>o!==null)?`[${r.join(", ")}]`:null}let s=e.includes("number")||e.includes("integer")?Qr(n):null;if(s!==null){let r=Number(s);return e.includes("integer")&&!e.includes("number")&&!Number.isInteger(r)||i.minimum!==void 0&&r<i.minimum||i.maximum!==void 0&&r>i.maximum?null:s}return e.includes("object")&&/^\{.*\}$/.test(n)?n:e.includes("boolean")?["true","false"].includes(n)?n:null:e.includes("string")&&(!i.pattern||new RegExp(i.pattern).test(n))?JSON.stringify(n):null}var Kf=i=>i.properties??i.oneOf?.find(t=>t.properties)?.properties;function jf(i,t){let e=Yf(t)?"value":t.oneOf?"path":null;return Object.entries(Kf(t)??{}).flatMap(([n,s])=>[...Yf(s)?[{table:i,key:n,schema:s,other:e}]:[],...jf(`${i}.${n}`,s)])}var Zf=(i,t)=>Ai(i).some(e=>e.table===t),Qf=i=>[i.replace(/\.?[^.]*$/,""),i.replace(/^.*\./,"")],kh=(i,t)=>re(i,...Qf(t.table)),H0=(i,t)=>re(i,t.table,t.key)??(t.other==="path"&&t.key==="path"?kh(i,t):null);function W0(i,t,e){let n=t.other==="path"?kh(i,t):null;return n===null?ge(i,t.table,t.key,e):(i=ge(i,...Qf(t.table),t.key==="path"?e:null),t.key==="path"?i:ge(ge(i,t.table,"path",n),t.table,t.key,e))}function Zs(i){let t=i.match(/^("""|''')\r?\n?([\s\S]*)\1$/);if(t)return t[2];if(/^'.*'$/.test(i))return i.slice(1,-1);if(!/^".*"$/.test(i))return i;try{return JSON.parse(i)}catch{return i}}var Ra=class{constructor(t,e,n,s){this.profiles=e;this.text=n;this.change=s;let r=S("input",{type:"search",placeholder:"Search the settings","aria-label":"Search the settings",oninput:()=>{let a=r.value.toLowerCase().split(/\s+/).filter(l=>l);for(let l of o){let c=0;for(let h of l.querySelectorAll(".setting"))h.hidden=!a.every(u=>h.dataset.words.includes(u)),c+=h.hidden||h.dataset.off?0:1;l.hidden=c===0,l.open=a.length>0&&c>0}}}),o=Object.entries(t.properties??{}).filter(([,a])=>a.properties).map(([a,l])=>{let c=S("span",{class:"note"}),h=jf(a,l).map(u=>this.field(u));return this.update.push(()=>{let u=h.filter(d=>d.dataset.stated).length;c.textContent=u>0?` ${u} stated`:""}),S("details",{class:"settings"},S("summary",{},a,c),...h)});this.element=S("div",{},r,...o),this.refresh()}profiles;text;change;element;update=[];refresh(){this.update.forEach(t=>t())}unstated(t){let e=re(this.text(),t.table,"profile"),n=this.profiles.find(r=>r.kind===t.table&&(e?r.name===Zs(e):!1)),s=n?re(n.toml,"",t.key):null;return s!==null?{value:s,from:`profile ${n.name}`}:{value:t.schema.default===void 0?"":Jf(t.schema.default),from:"default"}}field(t){let{table:e,key:n,schema:s}=t,r=`set-${e}-${n}`,o=p=>{this.change(W0(this.text(),t,p)),this.refresh()},a;if(s.enum){let p=new Map((s.oneOf??[]).map(_=>[_.const,_.description]));a=S("select",{id:r},...s.enum.map(_=>S("option",{value:String(_),title:p.get(_)??""},String(_))))}else[s.type].flat().includes("boolean")?a=S("select",{id:r},S("option",{value:"true"},"true"),S("option",{value:"false"},"false")):a=S("input",{id:r,type:"text",spellcheck:"false"});let l=p=>p.includes(`
`),c=()=>{let p=G0(s,a.value),_=s.minimum!==void 0?` from ${s.minimum} to ${s.maximum}`:"";return Es(a,p===null?`should be ${[s.type].flat().join(" or ")}${_}`:"",u),p};a.addEventListener("input",c),a.addEventListener("change",()=>{let p=c();p!==null&&o(p)});let h=S("button",{type:"button",title:"Take the line out of the job","aria-label":`Reset ${e}.${n}`,onclick:()=>{Es(a,"",u),o(null)}},"↺"),u=S("div",{class:"value"},a,h),d=S("span",{class:"note"}),f=S("div",{class:"setting"},S("label",{for:r},(e.includes(".")?`${e.split(".").slice(1).join(".")}.`:"")+n),u,S("p",{class:"note"},s.description??"",s["x-first-stage"]==="stress"?" A change solves the stress again. ":" ",d));return f.dataset.words=`${e}.${n} ${s.description??""}`.toLowerCase(),this.update.push(()=>{let p=this.text(),_=H0(p,t),m=Kf(s)!==void 0&&Zf(p,`${e}.${n}`),g=kh(p,t);f.dataset.off=(t.other==="value"?!Zf(p,e):g!==null&&(t.other===null||g.startsWith("{")))?"yes":"";let y=this.unstated(t);f.dataset.stated=_===null?"":"yes",h.hidden=_===null;let b=Zs(_??y.value);a.disabled=l(b)||m,document.activeElement!==a&&ti(a,m?"(a table: its rows follow)":l(b)?"(several lines: change it in the text)":b,u),d.textContent=_===null?`(${y.from})`:`(${y.from}: ${Zs(y.value)||"none"})`}),f}};var $0=400,tp=i=>/^([/\\]|[A-Za-z]:)/.test(i),Fe=i=>JSON.stringify(i);function Ca(i,t){let e=[["shape","mesh"],["shape","outline"],["shape","ct"],["shape.ct","path"],["guide","import"],["guide","volume"],["guide.volume","path"],["guide","field"],["guide.field","path"]],n=[["printer","profile"],["material","profile"],["process","profile"]];for(let[s,r]of[...e,...n]){let o=Zs(re(i,s,r)??""),a=r!=="profile"||o.endsWith(".toml");o&&a&&!tp(o)&&(i=ge(i,s,r,Fe(`${t}/${o}`)))}for(let s of["shape.photo","guide.image"]){let r=Qe(re(i,s,"files")??"");!Array.isArray(r)||!r.every(o=>typeof o=="string")||(i=ge(i,s,"files",`[${r.map(o=>Fe(tp(o)?o:`${t}/${o}`)).join(", ")}]`))}return i}var Pa=class{constructor(t,e){this.panel=t;this.parts=e;this.close()}panel;parts;editor=null;opened=null;saved="";folder="";picture=null;isActive=!1;before=[];after=[];isTyping=!1;changed=()=>{};notice=null;onText=()=>{};close(){this.dropPicture(),this.editor=null,this.opened=null,this.notice=null,this.changed=()=>{},[this.before,this.after]=[[],[]],this.panel.replaceChildren(S("p",{class:"note"},"A job says how a part is made: its shape, printer, material, loads and fill. Open a mesh or a job file to plan it."))}text(){return this.editor?.value??null}wanted(){return!this.editor||!this.opened?null:this.opened.kind==="job"&&this.editor.value===this.saved?{file:this.opened.path}:{text:this.textElsewhere(),name:this.opened.name.replace(/\.[^.]*$/,"")}}textElsewhere(){let t=this.editor?.value??"";return this.opened?.kind==="job"?Ca(t,this.folder):t}async saveAs(t){if(!this.editor||!t.trim())return;let e=this.textElsewhere();try{let{path:n}=await gf(/\.toml$/i.test(t)?t.trim():`${t.trim()}.toml`,e);this.opened&&await Ma(this.opened.path),this.opened={path:n,kind:"job",name:n.split(/[/\\]/).pop()??n},[this.saved,this.folder]=[e,n.replace(/[/\\][^/\\]*$/,"")],this.put(e),this.parts.renamed(n),this.parts.say(`Saved as ${n}`)}catch(n){this.parts.say(n.message,!0)}}put(t){!this.editor||this.editor.value===t||(this.record(),this.isTyping=!1,this.editor.value=t,this.changed())}record(){this.before.push(this.shown),this.after=[]}get canUndo(){return this.before.length>0}get canRedo(){return this.after.length>0}undo(){this.step(this.before,this.after)}redo(){this.step(this.after,this.before)}step(t,e){let n=t.pop();n===void 0||!this.editor||(e.push(this.editor.value),this.isTyping=!1,this.editor.value=n,this.changed())}shown="";async open(t){this.opened=t,this.notice=null;try{if(t.kind==="job"){let{text:e,folder:n}=await ua(t.path);[this.saved,this.folder]=[e,n]}else[this.saved,this.folder]=[(await yf(t.path)).text,""];await this.build(),await this.takeDraft()}catch(e){this.close(),this.parts.say(e.message,!0)}}async takeDraft(){let t=(await wa()).find(n=>n.path===this.opened?.path);if(!t||t.text===this.saved)return;let e=new Date(1e3*t.at_s).toLocaleString();t.from===this.saved?(this.put(t.text),this.notice=`Your changes of ${e}, which were not saved, are here again. Ctrl+Z takes the text of the file.`):(this.after=[t.text],this.notice=`The file was changed since your changes of ${e}, which were not saved. Ctrl+Shift+Z takes yours.`)}async build(){let[{profiles:t},e]=await Promise.all([da(),bf()]),n=S("textarea",{spellcheck:"false","aria-label":"Job file, TOML",oninput:()=>{this.isTyping||this.record(),this.isTyping=!0,h()}});n.value=this.saved,this.editor=n,[this.before,this.after,this.isTyping,this.shown]=[[],[],!1,this.saved];let s=new Ra(e,t,()=>n.value,m=>this.put(m)),r=S("p",{class:"note"}),o=S("p",{class:"error",id:"job-error",role:"alert",hidden:!0}),a,l=async()=>{let m=n.value,g=await _f(this.textElsewhere());this.editor!==n||n.value!==m||([o.textContent,o.hidden]=[g,g===""])},c=[],h=()=>{this.opened&&(this.before.length>0||this.after.length>0)&&Dh({path:this.opened.path,kind:this.opened.kind,text:n.value,from:this.saved}).catch(m=>this.parts.say(m.message,!0)),this.shown=n.value,s.refresh(),r.textContent=this.tier(t,n.value),c.forEach(m=>m()),clearTimeout(a),a=setTimeout(()=>{l()},$0),this.onText(n.value)};this.changed=h;let u=m=>{let g=S("select",{onchange:()=>this.put(ge(n.value,m,"profile",Fe(g.value)))},...t.filter(y=>y.kind===m).map(y=>S("option",{value:y.name,title:y.about},y.name)));return c.push(()=>{let y=(re(n.value,m,"profile")??"").replace(/^"|"$/g,"");y&&![...g.options].some(b=>b.value===y)&&g.append(S("option",{value:y},y)),y&&(g.value=y)}),S("label",{},m[0].toUpperCase()+m.slice(1),g)},d=S("button",{type:"button",class:"main",onclick:()=>{this.plan()}},"Plan the paths"),f=S("input",{id:"save-name","aria-label":"Name of the job file",placeholder:"name.toml",onkeydown:m=>{m.key==="Enter"&&this.saveAs(f.value)}}),p=S("button",{type:"button",id:"save-as",onclick:()=>{this.saveAs(f.value)}},"Save as"),_=this.board();_&&c.push(_.fill),this.showPicture(),this.panel.replaceChildren(..._?[_.box]:[],S("h2",{},"Printer, material, process"),S("div",{class:"row"},u("printer"),u("material"),u("process")),r,S("h2",{},"Settings"),s.element,S("h2",{},"Job file"),n,o,S("p",{class:"note"},"What runs is this text, saved as a job file: the command line gives the same bytes from it."),S("div",{class:"row"},S("label",{},"name, below the folder of results",f),p),S("div",{class:"row"},d)),h()}setActive(t){this.isActive=t,this.showPicture()}showPicture(){this.picture&&(this.picture.element.hidden=!this.isActive)}dropPicture(){this.picture?.element.remove(),this.picture=null}board(){if(this.dropPicture(),re(this.saved,"shape.photo","files")===null)return null;let t=()=>{let p=Qe(re(Ca(this.text()??"",this.folder),"shape.photo","files")??"");return Array.isArray(p)?p.map(String):[]},e=()=>{let p=Qe(re(this.text()??"","shape.photo","corners_px")??""),_=m=>Array.isArray(m)&&m.length===2&&m.every(g=>typeof g=="number");return Array.isArray(p)&&p.length%4===0&&p.every(_)?p:[]},n=()=>e().length>4?4*o.selectedIndex:0,s=p=>{let _=e();p&&_.splice(n(),4,...p),this.put(ge(this.text()??"","shape.photo","corners_px",p?`[${_.map(([m,g])=>`[${m}, ${g}]`).join(", ")}]`:null))},r=this.picture=new Ta(s,p=>this.parts.say(p,!0));Tt("view").after(r.element);let o=S("select",{id:"which-photo",onchange:()=>d()},...t().map(p=>S("option",{},p.split(/[/\\]/).pop()??p))),a=S("p",{class:"note"}),l=S("button",{type:"button",id:"whole-photo",onclick:()=>s(null)},"The whole picture is the board"),c=["width, mm","height, mm","thick, mm"].map((p,_)=>An({id:`board-${_}`,"aria-label":p,placeholder:p},{isPositive:!0},()=>h())),h=()=>{let[p,_,m]=c.map(va),g=this.text()??"";p>0&&_>0&&(g=ge(g,"shape.photo","size_mm",`[${p}, ${_}]`)),m>0&&(g=ge(g,"shape.photo","thickness_mm",String(m))),this.put(g)},u=S("p",{class:"note"},"No picture says how large the board in it is: measure it. Without corners the whole picture is the board."),d=()=>{let[p,_]=["size_mm","thickness_mm"].map(M=>Qe(re(this.text()??"","shape.photo",M)??"")),m=[...Array.isArray(p)?p:[void 0,void 0],_];c.forEach((M,A)=>{M!==document.activeElement&&typeof m[A]=="number"&&ti(M,m[A])}),u.hidden=m.every(M=>typeof M=="number");let g=e();l.disabled=g.length===0;let y=Zs(re(this.text()??"","shape.photo","corners")??""),b=g.length===0&&y!==""&&y!=="image";a.textContent=`${b?`The board is found by its ${y}, unless a ring is dragged. `:""}Drag the four rings to the corners of the board; the arrow keys move the ring that has the focus by a pixel, with shift by ten.`;let v=t()[o.selectedIndex];v!==void 0&&r.show(mf(v),g.length>=n()+4?g.slice(n(),n()+4):null)},f=t().length>1?[S("div",{class:"row"},S("label",{},"picture",o))]:[];return{box:S("div",{id:"board"},S("h2",{},"Board"),S("div",{class:"row three"},...c.map(p=>S("label",{},p.placeholder,p))),u,...f,a,S("div",{class:"row"},l)),fill:d}}tier(t,e){let n=re(e,"material","profile")?.replace(/^"|"$/g,"")??"pla",r=(t.find(o=>o.kind==="material"&&o.name===n)?.toml??"").match(/strength_tier\s*=\s*"([^"]*)"/)?.[1];return r?`Strength card of ${n}: tier ${r}`:`${n}: no strength card`}async plan(){let t=this.wanted();if(!t)return;let e=await this.parts.run({kind:"plan",...t});e&&document.dispatchEvent(new CustomEvent("planned",{detail:e.id}))}};var us={LEFT:0,MIDDLE:1,RIGHT:2,ROTATE:0,DOLLY:1,PAN:2},ds={ROTATE:0,PAN:1,DOLLY_PAN:2,DOLLY_ROTATE:3},Dp=0,gu=1,Np=2;var Io=1,Fp=2,Sr=3,oi=0,nn=1,Te=2,Ds=0,Mr=1,_u=2,yu=3,xu=4,Up=5;var Ns=100,Op=101,Bp=102,kp=103,zp=104,Vp=200,Gp=201,Hp=202,Wp=203,vu=204,bu=205,$p=206,Xp=207,qp=208,Yp=209,Zp=210,Jp=211,Kp=212,jp=213,Qp=214,al=0,ll=1,cl=2,fr=3,hl=4,ul=5,dl=6,fl=7,Su=0,tm=1,em=2,gi=0,Mu=1,wu=2,Au=3,Eu=4,Tu=5,Ru=6,Cu=7;var Pu=300,Fs=301,wr=302,zl=303,Vl=304,pl=1e3,pi=1001,ml=1002,ye=1003,nm=1004;var Lo=1005;var yn=1006,Gl=1007;var Vi=1008;var Bn=1009,Iu=1010,Lu=1011,Ar=1012,Hl=1013,ai=1014,Rn=1015,li=1016,Wl=1017,$l=1018,Us=1020,Du=35902,Nu=35899,Fu=1021,Uu=1022,sn=1023,Li=1026,Gi=1027,Do=1028,Xl=1029,_i=1030,ql=1031;var Yl=1033,No=33776,Fo=33777,Uo=33778,Oo=33779,Zl=35840,Jl=35841,Kl=35842,jl=35843,Ql=36196,tc=37492,ec=37496,nc=37488,ic=37489,Bo=37490,sc=37491,rc=37808,oc=37809,ac=37810,lc=37811,cc=37812,hc=37813,uc=37814,dc=37815,fc=37816,pc=37817,mc=37818,gc=37819,_c=37820,yc=37821,xc=36492,vc=36494,bc=36495,Sc=36283,Mc=36284,ko=36285,wc=36286;var co=2300,gl=2301,rl=2302,lu=2303,cu=2400,hu=2401,uu=2402;var im=3200;var Ou=0,sm=1,Hi="",Fn="srgb",ho="srgb-linear",uo="linear",oe="srgb";var ol=7680;var rm=519,om=512,am=513,lm=514,Bu=515,cm=516,hm=517,ku=518,zu=519,Vu=35044;var Cn="300 es",Jn=2e3,fo=2001;function X0(i){for(let t=i.length-1;t>=0;--t)if(i[t]>=65535)return!0;return!1}function q0(i){return ArrayBuffer.isView(i)&&!(i instanceof DataView)}function po(i){return document.createElementNS("http://www.w3.org/1999/xhtml",i)}function um(){let i=po("canvas");return i.style.display="block",i}var ep={},pr=null;function mo(...i){let t="THREE."+i.shift();pr?pr("log",t,...i):console.log(t,...i)}function dm(i){let t=i[0];if(typeof t=="string"&&t.startsWith("TSL:")){let e=i[1];e&&e.isStackTrace?i[0]+=" "+e.getLocation():i[1]='Stack trace not available. Enable "THREE.Node.captureStackTrace" to capture stack traces.'}return i}function It(...i){i=dm(i);let t="THREE."+i.shift();if(pr)pr("warn",t,...i);else{let e=i[0];e&&e.isStackTrace?console.warn(e.getError(t)):console.warn(t,...i)}}function Nt(...i){i=dm(i);let t="THREE."+i.shift();if(pr)pr("error",t,...i);else{let e=i[0];e&&e.isStackTrace?console.error(e.getError(t)):console.error(t,...i)}}function ao(...i){let t=i.join(" ");t in ep||(ep[t]=!0,It(...i))}function fm(i,t,e){return new Promise(function(n,s){function r(){switch(i.clientWaitSync(t,i.SYNC_FLUSH_COMMANDS_BIT,0)){case i.WAIT_FAILED:s();break;case i.TIMEOUT_EXPIRED:setTimeout(r,e);break;default:n()}}setTimeout(r,e)})}var pm={[al]:al,[cl]:dl,[hl]:hl,[fr]:ul,[ll]:ll,[dl]:cl,[fl]:fl,[ul]:fr},si=class{addEventListener(t,e){this._listeners===void 0&&(this._listeners={});let n=this._listeners;n[t]===void 0&&(n[t]=[]),n[t].indexOf(e)===-1&&n[t].push(e)}hasEventListener(t,e){let n=this._listeners;return n===void 0?!1:n[t]!==void 0&&n[t].indexOf(e)!==-1}removeEventListener(t,e){let n=this._listeners;if(n===void 0)return;let s=n[t];if(s!==void 0){let r=s.indexOf(e);r!==-1&&s.splice(r,1)}}dispatchEvent(t){let e=this._listeners;if(e===void 0)return;let n=e[t.type];if(n!==void 0){t.target=this;let s=n.slice(0);for(let r=0,o=s.length;r<o;r++)s[r].call(this,t);t.target=null}}},hn=["00","01","02","03","04","05","06","07","08","09","0a","0b","0c","0d","0e","0f","10","11","12","13","14","15","16","17","18","19","1a","1b","1c","1d","1e","1f","20","21","22","23","24","25","26","27","28","29","2a","2b","2c","2d","2e","2f","30","31","32","33","34","35","36","37","38","39","3a","3b","3c","3d","3e","3f","40","41","42","43","44","45","46","47","48","49","4a","4b","4c","4d","4e","4f","50","51","52","53","54","55","56","57","58","59","5a","5b","5c","5d","5e","5f","60","61","62","63","64","65","66","67","68","69","6a","6b","6c","6d","6e","6f","70","71","72","73","74","75","76","77","78","79","7a","7b","7c","7d","7e","7f","80","81","82","83","84","85","86","87","88","89","8a","8b","8c","8d","8e","8f","90","91","92","93","94","95","96","97","98","99","9a","9b","9c","9d","9e","9f","a0","a1","a2","a3","a4","a5","a6","a7","a8","a9","aa","ab","ac","ad","ae","af","b0","b1","b2","b3","b4","b5","b6","b7","b8","b9","ba","bb","bc","bd","be","bf","c0","c1","c2","c3","c4","c5","c6","c7","c8","c9","ca","cb","cc","cd","ce","cf","d0","d1","d2","d3","d4","d5","d6","d7","d8","d9","da","db","dc","dd","de","df","e0","e1","e2","e3","e4","e5","e6","e7","e8","e9","ea","eb","ec","ed","ee","ef","f0","f1","f2","f3","f4","f5","f6","f7","f8","f9","fa","fb","fc","fd","fe","ff"],np=1234567,ur=Math.PI/180,mr=180/Math.PI;function fs(){let i=Math.random()*4294967295|0,t=Math.random()*4294967295|0,e=Math.random()*4294967295|0,n=Math.random()*4294967295|0;return(hn[i&255]+hn[i>>8&255]+hn[i>>16&255]+hn[i>>24&255]+"-"+hn[t&255]+hn[t>>8&255]+"-"+hn[t>>16&15|64]+hn[t>>24&255]+"-"+hn[e&63|128]+hn[e>>8&255]+"-"+hn[e>>16&255]+hn[e>>24&255]+hn[n&255]+hn[n>>8&255]+hn[n>>16&255]+hn[n>>24&255]).toLowerCase()}function Vt(i,t,e){return Math.max(t,Math.min(e,i))}function Gu(i,t){return(i%t+t)%t}function Y0(i,t,e,n,s){return n+(i-t)*(s-n)/(e-t)}function Z0(i,t,e){return i!==t?(e-i)/(t-i):0}function lo(i,t,e){return(1-e)*i+e*t}function J0(i,t,e,n){return lo(i,t,1-Math.exp(-e*n))}function K0(i,t=1){return t-Math.abs(Gu(i,t*2)-t)}function j0(i,t,e){return i<=t?0:i>=e?1:(i=(i-t)/(e-t),i*i*(3-2*i))}function Q0(i,t,e){return i<=t?0:i>=e?1:(i=(i-t)/(e-t),i*i*i*(i*(i*6-15)+10))}function t_(i,t){return i+Math.floor(Math.random()*(t-i+1))}function e_(i,t){return i+Math.random()*(t-i)}function n_(i){return i*(.5-Math.random())}function i_(i){i!==void 0&&(np=i);let t=np+=1831565813;return t=Math.imul(t^t>>>15,t|1),t^=t+Math.imul(t^t>>>7,t|61),((t^t>>>14)>>>0)/4294967296}function s_(i){return i*ur}function r_(i){return i*mr}function o_(i){return i>0&&Number.isInteger(i)&&2**Math.round(Math.log2(i))===i}function a_(i){return Math.pow(2,Math.ceil(Math.log(i)/Math.LN2))}function Hu(i){return Math.pow(2,Math.floor(Math.log(i)/Math.LN2))}function l_(i,t,e,n,s){let r=Math.cos,o=Math.sin,a=r(e/2),l=o(e/2),c=r((t+n)/2),h=o((t+n)/2),u=r((t-n)/2),d=o((t-n)/2),f=r((n-t)/2),p=o((n-t)/2);switch(s){case"XYX":i.set(a*h,l*u,l*d,a*c);break;case"YZY":i.set(l*d,a*h,l*u,a*c);break;case"ZXZ":i.set(l*u,l*d,a*h,a*c);break;case"XZX":i.set(a*h,l*p,l*f,a*c);break;case"YXY":i.set(l*f,a*h,l*p,a*c);break;case"ZYZ":i.set(l*p,l*f,a*h,a*c);break;default:It("MathUtils: .setQuaternionFromProperEuler() encountered an unknown order: "+s)}}function Ac(i){switch(i.constructor){case Uint32Array:return 4294967295;case Uint16Array:return 65535;case Uint8Array:case Uint8ClampedArray:return 255;case Int32Array:return 2147483647;case Int16Array:return 32767;case Int8Array:return 127;default:return}}function Wu(i,t){if(t.constructor===Float32Array)return i;let e=Ac(t);if(e===void 0)throw new Error("THREE.MathUtils: Invalid component type.");return Math.max(i/e,-1)}function $u(i,t){if(t.constructor===Float32Array)return i;let e=Ac(t);if(e===void 0)throw new Error("THREE.MathUtils: Invalid component type.");return Math.round(i*e)}var Xu={DEG2RAD:ur,RAD2DEG:mr,generateUUID:fs,clamp:Vt,euclideanModulo:Gu,mapLinear:Y0,inverseLerp:Z0,lerp:lo,damp:J0,pingpong:K0,smoothstep:j0,smootherstep:Q0,randInt:t_,randFloat:e_,randFloatSpread:n_,seededRandom:i_,degToRad:s_,radToDeg:r_,isPowerOfTwo:o_,ceilPowerOfTwo:a_,floorPowerOfTwo:Hu,setQuaternionFromProperEuler:l_,normalize:$u,denormalize:Wu},St=class{static{this.prototype.isVector2=!0}constructor(t=0,e=0){this.x=t,this.y=e}get width(){return this.x}set width(t){this.x=t}get height(){return this.y}set height(t){this.y=t}set(t,e){return this.x=t,this.y=e,this}setScalar(t){return this.x=t,this.y=t,this}setX(t){return this.x=t,this}setY(t){return this.y=t,this}setComponent(t,e){switch(t){case 0:this.x=e;break;case 1:this.y=e;break;default:throw new Error("THREE.Vector2: index is out of range: "+t)}return this}getComponent(t){switch(t){case 0:return this.x;case 1:return this.y;default:throw new Error("THREE.Vector2: index is out of range: "+t)}}clone(){return new this.constructor(this.x,this.y)}copy(t){return this.x=t.x,this.y=t.y,this}add(t){return this.x+=t.x,this.y+=t.y,this}addScalar(t){return this.x+=t,this.y+=t,this}addVectors(t,e){return this.x=t.x+e.x,this.y=t.y+e.y,this}addScaledVector(t,e){return this.x+=t.x*e,this.y+=t.y*e,this}sub(t){return this.x-=t.x,this.y-=t.y,this}subScalar(t){return this.x-=t,this.y-=t,this}subVectors(t,e){return this.x=t.x-e.x,this.y=t.y-e.y,this}multiply(t){return this.x*=t.x,this.y*=t.y,this}multiplyScalar(t){return this.x*=t,this.y*=t,this}divide(t){return this.x/=t.x,this.y/=t.y,this}divideScalar(t){return this.multiplyScalar(1/t)}applyMatrix3(t){let e=this.x,n=this.y,s=t.elements;return this.x=s[0]*e+s[3]*n+s[6],this.y=s[1]*e+s[4]*n+s[7],this}min(t){return this.x=Math.min(this.x,t.x),this.y=Math.min(this.y,t.y),this}max(t){return this.x=Math.max(this.x,t.x),this.y=Math.max(this.y,t.y),this}clamp(t,e){return this.x=Vt(this.x,t.x,e.x),this.y=Vt(this.y,t.y,e.y),this}clampScalar(t,e){return this.x=Vt(this.x,t,e),this.y=Vt(this.y,t,e),this}clampLength(t,e){let n=this.length();return this.divideScalar(n||1).multiplyScalar(Vt(n,t,e))}floor(){return this.x=Math.floor(this.x),this.y=Math.floor(this.y),this}ceil(){return this.x=Math.ceil(this.x),this.y=Math.ceil(this.y),this}round(){return this.x=Math.round(this.x),this.y=Math.round(this.y),this}roundToZero(){return this.x=Math.trunc(this.x),this.y=Math.trunc(this.y),this}negate(){return this.x=-this.x,this.y=-this.y,this}dot(t){return this.x*t.x+this.y*t.y}cross(t){return this.x*t.y-this.y*t.x}lengthSq(){return this.x*this.x+this.y*this.y}length(){return Math.sqrt(this.x*this.x+this.y*this.y)}manhattanLength(){return Math.abs(this.x)+Math.abs(this.y)}normalize(){return this.divideScalar(this.length()||1)}angle(){return Math.atan2(-this.y,-this.x)+Math.PI}angleTo(t){let e=Math.sqrt(this.lengthSq()*t.lengthSq());if(e===0)return Math.PI/2;let n=this.dot(t)/e;return Math.acos(Vt(n,-1,1))}distanceTo(t){return Math.sqrt(this.distanceToSquared(t))}distanceToSquared(t){let e=this.x-t.x,n=this.y-t.y;return e*e+n*n}manhattanDistanceTo(t){return Math.abs(this.x-t.x)+Math.abs(this.y-t.y)}setLength(t){return this.normalize().multiplyScalar(t)}lerp(t,e){return this.x+=(t.x-this.x)*e,this.y+=(t.y-this.y)*e,this}lerpVectors(t,e,n){return this.x=t.x+(e.x-t.x)*n,this.y=t.y+(e.y-t.y)*n,this}equals(t){return t.x===this.x&&t.y===this.y}fromArray(t,e=0){return this.x=t[e],this.y=t[e+1],this}toArray(t=[],e=0){return t[e]=this.x,t[e+1]=this.y,t}fromBufferAttribute(t,e){return this.x=t.getX(e),this.y=t.getY(e),this}rotateAround(t,e){let n=Math.cos(e),s=Math.sin(e),r=this.x-t.x,o=this.y-t.y;return this.x=r*n-o*s+t.x,this.y=r*s+o*n+t.y,this}random(){return this.x=Math.random(),this.y=Math.random(),this}*[Symbol.iterator](){yield this.x,yield this.y}},Oe=class{constructor(t=0,e=0,n=0,s=1){this.isQuaternion=!0,this._x=t,this._y=e,this._z=n,this._w=s}static slerpFlat(t,e,n,s,r,o,a){let l=n[s+0],c=n[s+1],h=n[s+2],u=n[s+3],d=r[o+0],f=r[o+1],p=r[o+2],_=r[o+3];if(u!==_||l!==d||c!==f||h!==p){let m=l*d+c*f+h*p+u*_;m<0&&(d=-d,f=-f,p=-p,_=-_,m=-m);let g=1-a;if(m<.9995){let y=Math.acos(m),b=Math.sin(y);g=Math.sin(g*y)/b,a=Math.sin(a*y)/b,l=l*g+d*a,c=c*g+f*a,h=h*g+p*a,u=u*g+_*a}else{l=l*g+d*a,c=c*g+f*a,h=h*g+p*a,u=u*g+_*a;let y=1/Math.sqrt(l*l+c*c+h*h+u*u);l*=y,c*=y,h*=y,u*=y}}t[e]=l,t[e+1]=c,t[e+2]=h,t[e+3]=u}static multiplyQuaternionsFlat(t,e,n,s,r,o){let a=n[s],l=n[s+1],c=n[s+2],h=n[s+3],u=r[o],d=r[o+1],f=r[o+2],p=r[o+3];return t[e]=a*p+h*u+l*f-c*d,t[e+1]=l*p+h*d+c*u-a*f,t[e+2]=c*p+h*f+a*d-l*u,t[e+3]=h*p-a*u-l*d-c*f,t}get x(){return this._x}set x(t){this._x=t,this._onChangeCallback()}get y(){return this._y}set y(t){this._y=t,this._onChangeCallback()}get z(){return this._z}set z(t){this._z=t,this._onChangeCallback()}get w(){return this._w}set w(t){this._w=t,this._onChangeCallback()}set(t,e,n,s){return this._x=t,this._y=e,this._z=n,this._w=s,this._onChangeCallback(),this}clone(){return new this.constructor(this._x,this._y,this._z,this._w)}copy(t){return this._x=t.x,this._y=t.y,this._z=t.z,this._w=t.w,this._onChangeCallback(),this}setFromEuler(t,e=!0){let n=t._x,s=t._y,r=t._z,o=t._order,a=Math.cos,l=Math.sin,c=a(n/2),h=a(s/2),u=a(r/2),d=l(n/2),f=l(s/2),p=l(r/2);switch(o){case"XYZ":this._x=d*h*u+c*f*p,this._y=c*f*u-d*h*p,this._z=c*h*p+d*f*u,this._w=c*h*u-d*f*p;break;case"YXZ":this._x=d*h*u+c*f*p,this._y=c*f*u-d*h*p,this._z=c*h*p-d*f*u,this._w=c*h*u+d*f*p;break;case"ZXY":this._x=d*h*u-c*f*p,this._y=c*f*u+d*h*p,this._z=c*h*p+d*f*u,this._w=c*h*u-d*f*p;break;case"ZYX":this._x=d*h*u-c*f*p,this._y=c*f*u+d*h*p,this._z=c*h*p-d*f*u,this._w=c*h*u+d*f*p;break;case"YZX":this._x=d*h*u+c*f*p,this._y=c*f*u+d*h*p,this._z=c*h*p-d*f*u,this._w=c*h*u-d*f*p;break;case"XZY":this._x=d*h*u-c*f*p,this._y=c*f*u-d*h*p,this._z=c*h*p+d*f*u,this._w=c*h*u+d*f*p;break;default:It("Quaternion: .setFromEuler() encountered an unknown order: "+o)}return e===!0&&this._onChangeCallback(),this}setFromAxisAngle(t,e){let n=e/2,s=Math.sin(n);return this._x=t.x*s,this._y=t.y*s,this._z=t.z*s,this._w=Math.cos(n),this._onChangeCallback(),this}setFromRotationMatrix(t){let e=t.elements,n=e[0],s=e[4],r=e[8],o=e[1],a=e[5],l=e[9],c=e[2],h=e[6],u=e[10],d=n+a+u;if(d>0){let f=.5/Math.sqrt(d+1);this._w=.25/f,this._x=(h-l)*f,this._y=(r-c)*f,this._z=(o-s)*f}else if(n>a&&n>u){let f=2*Math.sqrt(1+n-a-u);this._w=(h-l)/f,this._x=.25*f,this._y=(s+o)/f,this._z=(r+c)/f}else if(a>u){let f=2*Math.sqrt(1+a-n-u);this._w=(r-c)/f,this._x=(s+o)/f,this._y=.25*f,this._z=(l+h)/f}else{let f=2*Math.sqrt(1+u-n-a);this._w=(o-s)/f,this._x=(r+c)/f,this._y=(l+h)/f,this._z=.25*f}return this._onChangeCallback(),this}setFromUnitVectors(t,e){let n=t.dot(e)+1;return n<1e-8?(n=0,Math.abs(t.x)>Math.abs(t.z)?(this._x=-t.y,this._y=t.x,this._z=0,this._w=n):(this._x=0,this._y=-t.z,this._z=t.y,this._w=n)):(this._x=t.y*e.z-t.z*e.y,this._y=t.z*e.x-t.x*e.z,this._z=t.x*e.y-t.y*e.x,this._w=n),this.normalize()}angleTo(t){return 2*Math.acos(Math.abs(Vt(this.dot(t),-1,1)))}rotateTowards(t,e){let n=this.angleTo(t);if(n===0)return this;let s=Math.min(1,e/n);return this.slerp(t,s),this}identity(){return this.set(0,0,0,1)}invert(){return this.conjugate()}conjugate(){return this._x*=-1,this._y*=-1,this._z*=-1,this._onChangeCallback(),this}dot(t){return this._x*t._x+this._y*t._y+this._z*t._z+this._w*t._w}lengthSq(){return this._x*this._x+this._y*this._y+this._z*this._z+this._w*this._w}length(){return Math.sqrt(this._x*this._x+this._y*this._y+this._z*this._z+this._w*this._w)}normalize(){let t=this.length();return t===0?(this._x=0,this._y=0,this._z=0,this._w=1):(t=1/t,this._x=this._x*t,this._y=this._y*t,this._z=this._z*t,this._w=this._w*t),this._onChangeCallback(),this}multiply(t){return this.multiplyQuaternions(this,t)}premultiply(t){return this.multiplyQuaternions(t,this)}multiplyQuaternions(t,e){let n=t._x,s=t._y,r=t._z,o=t._w,a=e._x,l=e._y,c=e._z,h=e._w;return this._x=n*h+o*a+s*c-r*l,this._y=s*h+o*l+r*a-n*c,this._z=r*h+o*c+n*l-s*a,this._w=o*h-n*a-s*l-r*c,this._onChangeCallback(),this}slerp(t,e){let n=t._x,s=t._y,r=t._z,o=t._w,a=this.dot(t);a<0&&(n=-n,s=-s,r=-r,o=-o,a=-a);let l=1-e;if(a<.9995){let c=Math.acos(a),h=Math.sin(c);l=Math.sin(l*c)/h,e=Math.sin(e*c)/h,this._x=this._x*l+n*e,this._y=this._y*l+s*e,this._z=this._z*l+r*e,this._w=this._w*l+o*e,this._onChangeCallback()}else this._x=this._x*l+n*e,this._y=this._y*l+s*e,this._z=this._z*l+r*e,this._w=this._w*l+o*e,this.normalize();return this}slerpQuaternions(t,e,n){return this.copy(t).slerp(e,n)}random(){let t=2*Math.PI*Math.random(),e=2*Math.PI*Math.random(),n=Math.random(),s=Math.sqrt(1-n),r=Math.sqrt(n);return this.set(s*Math.sin(t),s*Math.cos(t),r*Math.sin(e),r*Math.cos(e))}equals(t){return t._x===this._x&&t._y===this._y&&t._z===this._z&&t._w===this._w}fromArray(t,e=0){return this._x=t[e],this._y=t[e+1],this._z=t[e+2],this._w=t[e+3],this._onChangeCallback(),this}toArray(t=[],e=0){return t[e]=this._x,t[e+1]=this._y,t[e+2]=this._z,t[e+3]=this._w,t}fromBufferAttribute(t,e){return this._x=t.getX(e),this._y=t.getY(e),this._z=t.getZ(e),this._w=t.getW(e),this._onChangeCallback(),this}toJSON(){return this.toArray()}_onChange(t){return this._onChangeCallback=t,this}_onChangeCallback(){}*[Symbol.iterator](){yield this._x,yield this._y,yield this._z,yield this._w}},C=class{static{this.prototype.isVector3=!0}constructor(t=0,e=0,n=0){this.x=t,this.y=e,this.z=n}set(t,e,n){return n===void 0&&(n=this.z),this.x=t,this.y=e,this.z=n,this}setScalar(t){return this.x=t,this.y=t,this.z=t,this}setX(t){return this.x=t,this}setY(t){return this.y=t,this}setZ(t){return this.z=t,this}setComponent(t,e){switch(t){case 0:this.x=e;break;case 1:this.y=e;break;case 2:this.z=e;break;default:throw new Error("THREE.Vector3: index is out of range: "+t)}return this}getComponent(t){switch(t){case 0:return this.x;case 1:return this.y;case 2:return this.z;default:throw new Error("THREE.Vector3: index is out of range: "+t)}}clone(){return new this.constructor(this.x,this.y,this.z)}copy(t){return this.x=t.x,this.y=t.y,this.z=t.z,this}add(t){return this.x+=t.x,this.y+=t.y,this.z+=t.z,this}addScalar(t){return this.x+=t,this.y+=t,this.z+=t,this}addVectors(t,e){return this.x=t.x+e.x,this.y=t.y+e.y,this.z=t.z+e.z,this}addScaledVector(t,e){return this.x+=t.x*e,this.y+=t.y*e,this.z+=t.z*e,this}sub(t){return this.x-=t.x,this.y-=t.y,this.z-=t.z,this}subScalar(t){return this.x-=t,this.y-=t,this.z-=t,this}subVectors(t,e){return this.x=t.x-e.x,this.y=t.y-e.y,this.z=t.z-e.z,this}multiply(t){return this.x*=t.x,this.y*=t.y,this.z*=t.z,this}multiplyScalar(t){return this.x*=t,this.y*=t,this.z*=t,this}multiplyVectors(t,e){return this.x=t.x*e.x,this.y=t.y*e.y,this.z=t.z*e.z,this}applyEuler(t){return this.applyQuaternion(ip.setFromEuler(t))}applyAxisAngle(t,e){return this.applyQuaternion(ip.setFromAxisAngle(t,e))}applyMatrix3(t){let e=this.x,n=this.y,s=this.z,r=t.elements;return this.x=r[0]*e+r[3]*n+r[6]*s,this.y=r[1]*e+r[4]*n+r[7]*s,this.z=r[2]*e+r[5]*n+r[8]*s,this}applyNormalMatrix(t){return this.applyMatrix3(t).normalize()}applyMatrix4(t){let e=this.x,n=this.y,s=this.z,r=t.elements,o=1/(r[3]*e+r[7]*n+r[11]*s+r[15]);return this.x=(r[0]*e+r[4]*n+r[8]*s+r[12])*o,this.y=(r[1]*e+r[5]*n+r[9]*s+r[13])*o,this.z=(r[2]*e+r[6]*n+r[10]*s+r[14])*o,this}applyQuaternion(t){let e=this.x,n=this.y,s=this.z,r=t.x,o=t.y,a=t.z,l=t.w,c=2*(o*s-a*n),h=2*(a*e-r*s),u=2*(r*n-o*e);return this.x=e+l*c+o*u-a*h,this.y=n+l*h+a*c-r*u,this.z=s+l*u+r*h-o*c,this}project(t){return this.applyMatrix4(t.matrixWorldInverse).applyMatrix4(t.projectionMatrix)}unproject(t){return this.applyMatrix4(t.projectionMatrixInverse).applyMatrix4(t.matrixWorld)}transformDirection(t){let e=this.x,n=this.y,s=this.z,r=t.elements;return this.x=r[0]*e+r[4]*n+r[8]*s,this.y=r[1]*e+r[5]*n+r[9]*s,this.z=r[2]*e+r[6]*n+r[10]*s,this.normalize()}divide(t){return this.x/=t.x,this.y/=t.y,this.z/=t.z,this}divideScalar(t){return this.multiplyScalar(1/t)}min(t){return this.x=Math.min(this.x,t.x),this.y=Math.min(this.y,t.y),this.z=Math.min(this.z,t.z),this}max(t){return this.x=Math.max(this.x,t.x),this.y=Math.max(this.y,t.y),this.z=Math.max(this.z,t.z),this}clamp(t,e){return this.x=Vt(this.x,t.x,e.x),this.y=Vt(this.y,t.y,e.y),this.z=Vt(this.z,t.z,e.z),this}clampScalar(t,e){return this.x=Vt(this.x,t,e),this.y=Vt(this.y,t,e),this.z=Vt(this.z,t,e),this}clampLength(t,e){let n=this.length();return this.divideScalar(n||1).multiplyScalar(Vt(n,t,e))}floor(){return this.x=Math.floor(this.x),this.y=Math.floor(this.y),this.z=Math.floor(this.z),this}ceil(){return this.x=Math.ceil(this.x),this.y=Math.ceil(this.y),this.z=Math.ceil(this.z),this}round(){return this.x=Math.round(this.x),this.y=Math.round(this.y),this.z=Math.round(this.z),this}roundToZero(){return this.x=Math.trunc(this.x),this.y=Math.trunc(this.y),this.z=Math.trunc(this.z),this}negate(){return this.x=-this.x,this.y=-this.y,this.z=-this.z,this}dot(t){return this.x*t.x+this.y*t.y+this.z*t.z}lengthSq(){return this.x*this.x+this.y*this.y+this.z*this.z}length(){return Math.sqrt(this.x*this.x+this.y*this.y+this.z*this.z)}manhattanLength(){return Math.abs(this.x)+Math.abs(this.y)+Math.abs(this.z)}normalize(){return this.divideScalar(this.length()||1)}setLength(t){return this.normalize().multiplyScalar(t)}lerp(t,e){return this.x+=(t.x-this.x)*e,this.y+=(t.y-this.y)*e,this.z+=(t.z-this.z)*e,this}lerpVectors(t,e,n){return this.x=t.x+(e.x-t.x)*n,this.y=t.y+(e.y-t.y)*n,this.z=t.z+(e.z-t.z)*n,this}cross(t){return this.crossVectors(this,t)}crossVectors(t,e){let n=t.x,s=t.y,r=t.z,o=e.x,a=e.y,l=e.z;return this.x=s*l-r*a,this.y=r*o-n*l,this.z=n*a-s*o,this}projectOnVector(t){let e=t.lengthSq();if(e===0)return this.set(0,0,0);let n=t.dot(this)/e;return this.copy(t).multiplyScalar(n)}projectOnPlane(t){return zh.copy(this).projectOnVector(t),this.sub(zh)}reflect(t){return this.sub(zh.copy(t).multiplyScalar(2*this.dot(t)))}angleTo(t){let e=Math.sqrt(this.lengthSq()*t.lengthSq());if(e===0)return Math.PI/2;let n=this.dot(t)/e;return Math.acos(Vt(n,-1,1))}distanceTo(t){return Math.sqrt(this.distanceToSquared(t))}distanceToSquared(t){let e=this.x-t.x,n=this.y-t.y,s=this.z-t.z;return e*e+n*n+s*s}manhattanDistanceTo(t){return Math.abs(this.x-t.x)+Math.abs(this.y-t.y)+Math.abs(this.z-t.z)}setFromSpherical(t){return this.setFromSphericalCoords(t.radius,t.phi,t.theta)}setFromSphericalCoords(t,e,n){let s=Math.sin(e)*t;return this.x=s*Math.sin(n),this.y=Math.cos(e)*t,this.z=s*Math.cos(n),this}setFromCylindrical(t){return this.setFromCylindricalCoords(t.radius,t.theta,t.y)}setFromCylindricalCoords(t,e,n){return this.x=t*Math.sin(e),this.y=n,this.z=t*Math.cos(e),this}setFromMatrixPosition(t){let e=t.elements;return this.x=e[12],this.y=e[13],this.z=e[14],this}setFromMatrixScale(t){let e=this.setFromMatrixColumn(t,0).length(),n=this.setFromMatrixColumn(t,1).length(),s=this.setFromMatrixColumn(t,2).length();return this.x=e,this.y=n,this.z=s,this}setFromMatrixColumn(t,e){return this.fromArray(t.elements,e*4)}setFromMatrix3Column(t,e){return this.fromArray(t.elements,e*3)}setFromEuler(t){return this.x=t._x,this.y=t._y,this.z=t._z,this}setFromColor(t){return this.x=t.r,this.y=t.g,this.z=t.b,this}equals(t){return t.x===this.x&&t.y===this.y&&t.z===this.z}fromArray(t,e=0){return this.x=t[e],this.y=t[e+1],this.z=t[e+2],this}toArray(t=[],e=0){return t[e]=this.x,t[e+1]=this.y,t[e+2]=this.z,t}fromBufferAttribute(t,e){return this.x=t.getX(e),this.y=t.getY(e),this.z=t.getZ(e),this}random(){return this.x=Math.random(),this.y=Math.random(),this.z=Math.random(),this}randomDirection(){let t=Math.random()*Math.PI*2,e=Math.random()*2-1,n=Math.sqrt(1-e*e);return this.x=n*Math.cos(t),this.y=e,this.z=n*Math.sin(t),this}*[Symbol.iterator](){yield this.x,yield this.y,yield this.z}},zh=new C,ip=new Oe,Ut=class{static{this.prototype.isMatrix3=!0}constructor(t,e,n,s,r,o,a,l,c){this.elements=[1,0,0,0,1,0,0,0,1],t!==void 0&&this.set(t,e,n,s,r,o,a,l,c)}set(t,e,n,s,r,o,a,l,c){let h=this.elements;return h[0]=t,h[1]=s,h[2]=a,h[3]=e,h[4]=r,h[5]=l,h[6]=n,h[7]=o,h[8]=c,this}identity(){return this.set(1,0,0,0,1,0,0,0,1),this}copy(t){let e=this.elements,n=t.elements;return e[0]=n[0],e[1]=n[1],e[2]=n[2],e[3]=n[3],e[4]=n[4],e[5]=n[5],e[6]=n[6],e[7]=n[7],e[8]=n[8],this}extractBasis(t,e,n){return t.setFromMatrix3Column(this,0),e.setFromMatrix3Column(this,1),n.setFromMatrix3Column(this,2),this}setFromMatrix4(t){let e=t.elements;return this.set(e[0],e[4],e[8],e[1],e[5],e[9],e[2],e[6],e[10]),this}multiply(t){return this.multiplyMatrices(this,t)}premultiply(t){return this.multiplyMatrices(t,this)}multiplyMatrices(t,e){let n=t.elements,s=e.elements,r=this.elements,o=n[0],a=n[3],l=n[6],c=n[1],h=n[4],u=n[7],d=n[2],f=n[5],p=n[8],_=s[0],m=s[3],g=s[6],y=s[1],b=s[4],v=s[7],M=s[2],A=s[5],x=s[8];return r[0]=o*_+a*y+l*M,r[3]=o*m+a*b+l*A,r[6]=o*g+a*v+l*x,r[1]=c*_+h*y+u*M,r[4]=c*m+h*b+u*A,r[7]=c*g+h*v+u*x,r[2]=d*_+f*y+p*M,r[5]=d*m+f*b+p*A,r[8]=d*g+f*v+p*x,this}multiplyScalar(t){let e=this.elements;return e[0]*=t,e[3]*=t,e[6]*=t,e[1]*=t,e[4]*=t,e[7]*=t,e[2]*=t,e[5]*=t,e[8]*=t,this}determinant(){let t=this.elements,e=t[0],n=t[1],s=t[2],r=t[3],o=t[4],a=t[5],l=t[6],c=t[7],h=t[8];return e*o*h-e*a*c-n*r*h+n*a*l+s*r*c-s*o*l}invert(){let t=this.elements,e=t[0],n=t[1],s=t[2],r=t[3],o=t[4],a=t[5],l=t[6],c=t[7],h=t[8],u=h*o-a*c,d=a*l-h*r,f=c*r-o*l,p=e*u+n*d+s*f;if(p===0)return this.set(0,0,0,0,0,0,0,0,0);let _=1/p;return t[0]=u*_,t[1]=(s*c-h*n)*_,t[2]=(a*n-s*o)*_,t[3]=d*_,t[4]=(h*e-s*l)*_,t[5]=(s*r-a*e)*_,t[6]=f*_,t[7]=(n*l-c*e)*_,t[8]=(o*e-n*r)*_,this}transpose(){let t,e=this.elements;return t=e[1],e[1]=e[3],e[3]=t,t=e[2],e[2]=e[6],e[6]=t,t=e[5],e[5]=e[7],e[7]=t,this}getNormalMatrix(t){return this.setFromMatrix4(t).invert().transpose()}transposeIntoArray(t){let e=this.elements;return t[0]=e[0],t[1]=e[3],t[2]=e[6],t[3]=e[1],t[4]=e[4],t[5]=e[7],t[6]=e[2],t[7]=e[5],t[8]=e[8],this}setUvTransform(t,e,n,s,r,o,a){let l=Math.cos(r),c=Math.sin(r);return this.set(n*l,n*c,-n*(l*o+c*a)+o+t,-s*c,s*l,-s*(-c*o+l*a)+a+e,0,0,1),this}scale(t,e){return ao("Matrix3: .scale() is deprecated. Use .makeScale() instead."),this.premultiply(Vh.makeScale(t,e)),this}rotate(t){return ao("Matrix3: .rotate() is deprecated. Use .makeRotation() instead."),this.premultiply(Vh.makeRotation(-t)),this}translate(t,e){return ao("Matrix3: .translate() is deprecated. Use .makeTranslation() instead."),this.premultiply(Vh.makeTranslation(t,e)),this}makeTranslation(t,e){return t.isVector2?this.set(1,0,t.x,0,1,t.y,0,0,1):this.set(1,0,t,0,1,e,0,0,1),this}makeRotation(t){let e=Math.cos(t),n=Math.sin(t);return this.set(e,-n,0,n,e,0,0,0,1),this}makeScale(t,e){return this.set(t,0,0,0,e,0,0,0,1),this}equals(t){let e=this.elements,n=t.elements;for(let s=0;s<9;s++)if(e[s]!==n[s])return!1;return!0}fromArray(t,e=0){for(let n=0;n<9;n++)this.elements[n]=t[n+e];return this}toArray(t=[],e=0){let n=this.elements;return t[e]=n[0],t[e+1]=n[1],t[e+2]=n[2],t[e+3]=n[3],t[e+4]=n[4],t[e+5]=n[5],t[e+6]=n[6],t[e+7]=n[7],t[e+8]=n[8],t}clone(){return new this.constructor().fromArray(this.elements)}},Vh=new Ut,sp=new Ut().set(.4123908,.3575843,.1804808,.212639,.7151687,.0721923,.0193308,.1191948,.9505322),rp=new Ut().set(3.2409699,-1.5373832,-.4986108,-.9692436,1.8759675,.0415551,.0556301,-.203977,1.0569715);function c_(){let i={enabled:!0,workingColorSpace:ho,spaces:{},convert:function(s,r,o){return this.enabled===!1||r===o||!r||!o||(this.spaces[r].transfer===oe&&(s.r=Ii(s.r),s.g=Ii(s.g),s.b=Ii(s.b)),this.spaces[r].primaries!==this.spaces[o].primaries&&(s.applyMatrix3(this.spaces[r].toXYZ),s.applyMatrix3(this.spaces[o].fromXYZ)),this.spaces[o].transfer===oe&&(s.r=dr(s.r),s.g=dr(s.g),s.b=dr(s.b))),s},workingToColorSpace:function(s,r){return this.convert(s,this.workingColorSpace,r)},colorSpaceToWorking:function(s,r){return this.convert(s,r,this.workingColorSpace)},getPrimaries:function(s){return this.spaces[s].primaries},getTransfer:function(s){return s===Hi?uo:this.spaces[s].transfer},getToneMappingMode:function(s){return this.spaces[s].outputColorSpaceConfig.toneMappingMode||"standard"},getLuminanceCoefficients:function(s,r=this.workingColorSpace){return s.fromArray(this.spaces[r].luminanceCoefficients)},define:function(s){Object.assign(this.spaces,s)},_getMatrix:function(s,r,o){return s.copy(this.spaces[o].fromXYZ).multiply(this.spaces[r].toXYZ)},_getDrawingBufferColorSpace:function(s){return this.spaces[s].outputColorSpaceConfig.drawingBufferColorSpace},_getUnpackColorSpace:function(s=this.workingColorSpace){return this.spaces[s].workingColorSpaceConfig.unpackColorSpace}},t=[.64,.33,.3,.6,.15,.06],e=[.2126,.7152,.0722],n=[.3127,.329];return i.define({[ho]:{primaries:t,whitePoint:n,transfer:uo,toXYZ:sp,fromXYZ:rp,luminanceCoefficients:e,workingColorSpaceConfig:{unpackColorSpace:Fn},outputColorSpaceConfig:{drawingBufferColorSpace:Fn}},[Fn]:{primaries:t,whitePoint:n,transfer:oe,toXYZ:sp,fromXYZ:rp,luminanceCoefficients:e,outputColorSpaceConfig:{drawingBufferColorSpace:Fn}}}),i}var Jt=c_();function Ii(i){return i<.04045?i*.0773993808:Math.pow(i*.9478672986+.0521327014,2.4)}function dr(i){return i<.0031308?i*12.92:1.055*Math.pow(i,.41666)-.055}var Js,_l=class{static getDataURL(t,e="image/png"){if(/^data:/i.test(t.src)||typeof HTMLCanvasElement>"u")return t.src;let n;if(t instanceof HTMLCanvasElement)n=t;else{Js===void 0&&(Js=po("canvas")),Js.width=t.width,Js.height=t.height;let s=Js.getContext("2d");t instanceof ImageData?s.putImageData(t,0,0):s.drawImage(t,0,0,t.width,t.height),n=Js}return n.toDataURL(e)}static sRGBToLinear(t){if(typeof HTMLImageElement<"u"&&t instanceof HTMLImageElement||typeof HTMLCanvasElement<"u"&&t instanceof HTMLCanvasElement||typeof ImageBitmap<"u"&&t instanceof ImageBitmap){let e=po("canvas");e.width=t.width,e.height=t.height;let n=e.getContext("2d");n.drawImage(t,0,0,t.width,t.height);let s=n.getImageData(0,0,t.width,t.height),r=s.data;for(let o=0;o<r.length;o++)r[o]=Ii(r[o]/255)*255;return n.putImageData(s,0,0),e}else if(t.data){let e=t.data.slice(0);for(let n=0;n<e.length;n++)e instanceof Uint8Array||e instanceof Uint8ClampedArray?e[n]=Math.floor(Ii(e[n]/255)*255):e[n]=Ii(e[n]);return{data:e,width:t.width,height:t.height}}else return It("ImageUtils.sRGBToLinear(): Unsupported image type. No color space conversion applied."),t}},h_=0,gr=class{constructor(t=null){this.isTextureSource=!0,Object.defineProperty(this,"id",{value:h_++}),this.uuid=fs(),this.data=t,this.dataReady=!0,this.version=0}getSize(t){let e=this.data;return typeof HTMLVideoElement<"u"&&e instanceof HTMLVideoElement?t.set(e.videoWidth,e.videoHeight,0):typeof VideoFrame<"u"&&e instanceof VideoFrame?t.set(e.displayWidth,e.displayHeight,0):e!==null?t.set(e.width||0,e.height||0,e.depth||0):t.set(0,0,0),t}set needsUpdate(t){t===!0&&this.version++}toJSON(t){let e=t===void 0||typeof t=="string";if(!e&&t.images[this.uuid]!==void 0)return t.images[this.uuid];let n={uuid:this.uuid,url:""},s=this.data;if(s!==null){let r;if(Array.isArray(s)){r=[];for(let o=0,a=s.length;o<a;o++)s[o].isDataTexture?r.push(Gh(s[o].image)):r.push(Gh(s[o]))}else r=Gh(s);n.url=r}return e||(t.images[this.uuid]=n),n}};function Gh(i){return typeof HTMLImageElement<"u"&&i instanceof HTMLImageElement||typeof HTMLCanvasElement<"u"&&i instanceof HTMLCanvasElement||typeof ImageBitmap<"u"&&i instanceof ImageBitmap?_l.getDataURL(i):i.data?{data:Array.from(i.data),width:i.width,height:i.height,type:i.data.constructor.name}:(It("Texture: Unable to serialize Texture."),{})}var u_=0,Hh=new C,En=class i extends si{constructor(t=i.DEFAULT_IMAGE,e=i.DEFAULT_MAPPING,n=pi,s=pi,r=yn,o=Vi,a=sn,l=Bn,c=i.DEFAULT_ANISOTROPY,h=Hi){super(),this.isTexture=!0,Object.defineProperty(this,"id",{value:u_++}),this.uuid=fs(),this.name="",this.source=new gr(t),this.mipmaps=[],this.mapping=e,this.channel=0,this.wrapS=n,this.wrapT=s,this.magFilter=r,this.minFilter=o,this.anisotropy=c,this.format=a,this.internalFormat=null,this.type=l,this.offset=new St(0,0),this.repeat=new St(1,1),this.center=new St(0,0),this.rotation=0,this.matrixAutoUpdate=!0,this.matrix=new Ut,this.generateMipmaps=!0,this.mipmapsAutoUpdate=!0,this.premultiplyAlpha=!1,this.flipY=!0,this.unpackAlignment=4,this.colorSpace=h,this.userData={},this.updateRanges=[],this.version=0,this.onUpdate=null,this.renderTarget=null,this.isRenderTargetTexture=!1,this.isArrayTexture=!!(t&&t.depth&&t.depth>1),this.pmremVersion=0,this.isPMREMTexture=!1,this.normalized=!1}get width(){return this.source.getSize(Hh).x}get height(){return this.source.getSize(Hh).y}get depth(){return this.source.getSize(Hh).z}get image(){return this.source.data}set image(t){this.source.data=t}updateMatrix(){this.matrix.setUvTransform(this.offset.x,this.offset.y,this.repeat.x,this.repeat.y,this.rotation,this.center.x,this.center.y)}addUpdateRange(t,e){this.updateRanges.push({start:t,count:e})}clearUpdateRanges(){this.updateRanges.length=0}clone(){return new this.constructor().copy(this)}copy(t){return this.name=t.name,this.source=t.source,this.mipmaps=t.mipmaps.slice(0),this.mapping=t.mapping,this.channel=t.channel,this.wrapS=t.wrapS,this.wrapT=t.wrapT,this.magFilter=t.magFilter,this.minFilter=t.minFilter,this.anisotropy=t.anisotropy,this.format=t.format,this.internalFormat=t.internalFormat,this.type=t.type,this.normalized=t.normalized,this.offset.copy(t.offset),this.repeat.copy(t.repeat),this.center.copy(t.center),this.rotation=t.rotation,this.matrixAutoUpdate=t.matrixAutoUpdate,this.matrix.copy(t.matrix),this.generateMipmaps=t.generateMipmaps,this.mipmapsAutoUpdate=t.mipmapsAutoUpdate,this.premultiplyAlpha=t.premultiplyAlpha,this.flipY=t.flipY,this.unpackAlignment=t.unpackAlignment,this.colorSpace=t.colorSpace,this.renderTarget=t.renderTarget,this.isRenderTargetTexture=t.isRenderTargetTexture,this.isPMREMTexture=t.isPMREMTexture,this.isArrayTexture=t.isArrayTexture,this.userData=JSON.parse(JSON.stringify(t.userData)),this.needsUpdate=!0,this}setValues(t){for(let e in t){let n=t[e];if(n===void 0){It(`Texture.setValues(): parameter '${e}' has value of undefined.`);continue}let s=this[e];if(s===void 0){It(`Texture.setValues(): property '${e}' does not exist.`);continue}s&&n&&s.isVector2&&n.isVector2||s&&n&&s.isVector3&&n.isVector3||s&&n&&s.isMatrix3&&n.isMatrix3?s.copy(n):this[e]=n}}toJSON(t){let e=t===void 0||typeof t=="string";if(!e&&t.textures[this.uuid]!==void 0)return t.textures[this.uuid];let n={metadata:{version:4.7,type:"Texture",generator:"Texture.toJSON"},uuid:this.uuid,name:this.name,image:this.source.toJSON(t).uuid,mapping:this.mapping,channel:this.channel,repeat:[this.repeat.x,this.repeat.y],offset:[this.offset.x,this.offset.y],center:[this.center.x,this.center.y],rotation:this.rotation,wrap:[this.wrapS,this.wrapT],format:this.format,internalFormat:this.internalFormat,type:this.type,normalized:this.normalized,colorSpace:this.colorSpace,minFilter:this.minFilter,magFilter:this.magFilter,anisotropy:this.anisotropy,flipY:this.flipY,generateMipmaps:this.generateMipmaps,mipmapsAutoUpdate:this.mipmapsAutoUpdate,premultiplyAlpha:this.premultiplyAlpha,unpackAlignment:this.unpackAlignment};return Object.keys(this.userData).length>0&&(n.userData=this.userData),e||(t.textures[this.uuid]=n),n}dispose(){this.dispatchEvent({type:"dispose"})}transformUv(t){if(this.mapping!==Pu)return t;if(t.applyMatrix3(this.matrix),t.x<0||t.x>1)switch(this.wrapS){case pl:t.x=t.x-Math.floor(t.x);break;case pi:t.x=t.x<0?0:1;break;case ml:Math.abs(Math.floor(t.x)%2)===1?t.x=Math.ceil(t.x)-t.x:t.x=t.x-Math.floor(t.x);break}if(t.y<0||t.y>1)switch(this.wrapT){case pl:t.y=t.y-Math.floor(t.y);break;case pi:t.y=t.y<0?0:1;break;case ml:Math.abs(Math.floor(t.y)%2)===1?t.y=Math.ceil(t.y)-t.y:t.y=t.y-Math.floor(t.y);break}return this.flipY&&(t.y=1-t.y),t}set needsUpdate(t){t===!0&&(this.version++,this.source.needsUpdate=!0)}set needsPMREMUpdate(t){t===!0&&this.pmremVersion++}};En.DEFAULT_IMAGE=null;En.DEFAULT_MAPPING=Pu;En.DEFAULT_ANISOTROPY=1;var de=class{static{this.prototype.isVector4=!0}constructor(t=0,e=0,n=0,s=1){this.x=t,this.y=e,this.z=n,this.w=s}get width(){return this.z}set width(t){this.z=t}get height(){return this.w}set height(t){this.w=t}set(t,e,n,s){return this.x=t,this.y=e,this.z=n,this.w=s,this}setScalar(t){return this.x=t,this.y=t,this.z=t,this.w=t,this}setX(t){return this.x=t,this}setY(t){return this.y=t,this}setZ(t){return this.z=t,this}setW(t){return this.w=t,this}setComponent(t,e){switch(t){case 0:this.x=e;break;case 1:this.y=e;break;case 2:this.z=e;break;case 3:this.w=e;break;default:throw new Error("THREE.Vector4: index is out of range: "+t)}return this}getComponent(t){switch(t){case 0:return this.x;case 1:return this.y;case 2:return this.z;case 3:return this.w;default:throw new Error("THREE.Vector4: index is out of range: "+t)}}clone(){return new this.constructor(this.x,this.y,this.z,this.w)}copy(t){return this.x=t.x,this.y=t.y,this.z=t.z,this.w=t.w!==void 0?t.w:1,this}add(t){return this.x+=t.x,this.y+=t.y,this.z+=t.z,this.w+=t.w,this}addScalar(t){return this.x+=t,this.y+=t,this.z+=t,this.w+=t,this}addVectors(t,e){return this.x=t.x+e.x,this.y=t.y+e.y,this.z=t.z+e.z,this.w=t.w+e.w,this}addScaledVector(t,e){return this.x+=t.x*e,this.y+=t.y*e,this.z+=t.z*e,this.w+=t.w*e,this}sub(t){return this.x-=t.x,this.y-=t.y,this.z-=t.z,this.w-=t.w,this}subScalar(t){return this.x-=t,this.y-=t,this.z-=t,this.w-=t,this}subVectors(t,e){return this.x=t.x-e.x,this.y=t.y-e.y,this.z=t.z-e.z,this.w=t.w-e.w,this}multiply(t){return this.x*=t.x,this.y*=t.y,this.z*=t.z,this.w*=t.w,this}multiplyScalar(t){return this.x*=t,this.y*=t,this.z*=t,this.w*=t,this}applyMatrix4(t){let e=this.x,n=this.y,s=this.z,r=this.w,o=t.elements;return this.x=o[0]*e+o[4]*n+o[8]*s+o[12]*r,this.y=o[1]*e+o[5]*n+o[9]*s+o[13]*r,this.z=o[2]*e+o[6]*n+o[10]*s+o[14]*r,this.w=o[3]*e+o[7]*n+o[11]*s+o[15]*r,this}divide(t){return this.x/=t.x,this.y/=t.y,this.z/=t.z,this.w/=t.w,this}divideScalar(t){return this.multiplyScalar(1/t)}setAxisAngleFromQuaternion(t){this.w=2*Math.acos(t.w);let e=Math.sqrt(1-t.w*t.w);return e<1e-4?(this.x=1,this.y=0,this.z=0):(this.x=t.x/e,this.y=t.y/e,this.z=t.z/e),this}setAxisAngleFromRotationMatrix(t){let e,n,s,r,l=t.elements,c=l[0],h=l[4],u=l[8],d=l[1],f=l[5],p=l[9],_=l[2],m=l[6],g=l[10];if(Math.abs(h-d)<.01&&Math.abs(u-_)<.01&&Math.abs(p-m)<.01){if(Math.abs(h+d)<.1&&Math.abs(u+_)<.1&&Math.abs(p+m)<.1&&Math.abs(c+f+g-3)<.1)return this.set(1,0,0,0),this;e=Math.PI;let b=(c+1)/2,v=(f+1)/2,M=(g+1)/2,A=(h+d)/4,x=(u+_)/4,w=(p+m)/4;return b>v&&b>M?b<.01?(n=0,s=.707106781,r=.707106781):(n=Math.sqrt(b),s=A/n,r=x/n):v>M?v<.01?(n=.707106781,s=0,r=.707106781):(s=Math.sqrt(v),n=A/s,r=w/s):M<.01?(n=.707106781,s=.707106781,r=0):(r=Math.sqrt(M),n=x/r,s=w/r),this.set(n,s,r,e),this}let y=Math.sqrt((m-p)*(m-p)+(u-_)*(u-_)+(d-h)*(d-h));return Math.abs(y)<.001&&(y=1),this.x=(m-p)/y,this.y=(u-_)/y,this.z=(d-h)/y,this.w=Math.acos((c+f+g-1)/2),this}setFromMatrixPosition(t){let e=t.elements;return this.x=e[12],this.y=e[13],this.z=e[14],this.w=e[15],this}min(t){return this.x=Math.min(this.x,t.x),this.y=Math.min(this.y,t.y),this.z=Math.min(this.z,t.z),this.w=Math.min(this.w,t.w),this}max(t){return this.x=Math.max(this.x,t.x),this.y=Math.max(this.y,t.y),this.z=Math.max(this.z,t.z),this.w=Math.max(this.w,t.w),this}clamp(t,e){return this.x=Vt(this.x,t.x,e.x),this.y=Vt(this.y,t.y,e.y),this.z=Vt(this.z,t.z,e.z),this.w=Vt(this.w,t.w,e.w),this}clampScalar(t,e){return this.x=Vt(this.x,t,e),this.y=Vt(this.y,t,e),this.z=Vt(this.z,t,e),this.w=Vt(this.w,t,e),this}clampLength(t,e){let n=this.length();return this.divideScalar(n||1).multiplyScalar(Vt(n,t,e))}floor(){return this.x=Math.floor(this.x),this.y=Math.floor(this.y),this.z=Math.floor(this.z),this.w=Math.floor(this.w),this}ceil(){return this.x=Math.ceil(this.x),this.y=Math.ceil(this.y),this.z=Math.ceil(this.z),this.w=Math.ceil(this.w),this}round(){return this.x=Math.round(this.x),this.y=Math.round(this.y),this.z=Math.round(this.z),this.w=Math.round(this.w),this}roundToZero(){return this.x=Math.trunc(this.x),this.y=Math.trunc(this.y),this.z=Math.trunc(this.z),this.w=Math.trunc(this.w),this}negate(){return this.x=-this.x,this.y=-this.y,this.z=-this.z,this.w=-this.w,this}dot(t){return this.x*t.x+this.y*t.y+this.z*t.z+this.w*t.w}lengthSq(){return this.x*this.x+this.y*this.y+this.z*this.z+this.w*this.w}length(){return Math.sqrt(this.x*this.x+this.y*this.y+this.z*this.z+this.w*this.w)}manhattanLength(){return Math.abs(this.x)+Math.abs(this.y)+Math.abs(this.z)+Math.abs(this.w)}normalize(){return this.divideScalar(this.length()||1)}setLength(t){return this.normalize().multiplyScalar(t)}lerp(t,e){return this.x+=(t.x-this.x)*e,this.y+=(t.y-this.y)*e,this.z+=(t.z-this.z)*e,this.w+=(t.w-this.w)*e,this}lerpVectors(t,e,n){return this.x=t.x+(e.x-t.x)*n,this.y=t.y+(e.y-t.y)*n,this.z=t.z+(e.z-t.z)*n,this.w=t.w+(e.w-t.w)*n,this}equals(t){return t.x===this.x&&t.y===this.y&&t.z===this.z&&t.w===this.w}fromArray(t,e=0){return this.x=t[e],this.y=t[e+1],this.z=t[e+2],this.w=t[e+3],this}toArray(t=[],e=0){return t[e]=this.x,t[e+1]=this.y,t[e+2]=this.z,t[e+3]=this.w,t}fromBufferAttribute(t,e){return this.x=t.getX(e),this.y=t.getY(e),this.z=t.getZ(e),this.w=t.getW(e),this}random(){return this.x=Math.random(),this.y=Math.random(),this.z=Math.random(),this.w=Math.random(),this}*[Symbol.iterator](){yield this.x,yield this.y,yield this.z,yield this.w}},yl=class extends si{constructor(t=1,e=1,n={}){super(),n=Object.assign({generateMipmaps:!1,internalFormat:null,minFilter:yn,depthBuffer:!0,stencilBuffer:!1,resolveColorBuffer:!0,resolveDepthBuffer:!0,resolveStencilBuffer:!0,storeMultisampledColorBuffer:!0,storeMultisampledDepthBuffer:!0,storeMultisampledStencilBuffer:!0,depthTexture:null,samples:0,count:1,depth:1,multiview:!1,useArrayDepthTexture:!1},n),this.isRenderTarget=!0,this.width=t,this.height=e,this.depth=n.depth,this.scissor=new de(0,0,t,e),this.scissorTest=!1,this.viewport=new de(0,0,t,e),this.textures=[];let s=n.count;for(let r=0;r<s;r++)this.textures[r]=new En({width:t,height:e,depth:n.depth}),this.textures[r].isRenderTargetTexture=!0,this.textures[r].renderTarget=this;this._setTextureOptions(n),this.depthBuffer=n.depthBuffer,this.stencilBuffer=n.stencilBuffer,this.resolveColorBuffer=n.resolveColorBuffer,this.resolveDepthBuffer=n.resolveDepthBuffer,this.resolveStencilBuffer=n.resolveStencilBuffer,this.storeMultisampledColorBuffer=n.storeMultisampledColorBuffer,this.storeMultisampledDepthBuffer=n.storeMultisampledDepthBuffer,this.storeMultisampledStencilBuffer=n.storeMultisampledStencilBuffer,this._depthTexture=null,this.depthTexture=n.depthTexture,this.samples=n.samples,this.multiview=n.multiview,this.useArrayDepthTexture=n.useArrayDepthTexture}_setTextureOptions(t={}){let e={minFilter:yn,generateMipmaps:!1,flipY:!1,internalFormat:null};t.mapping!==void 0&&(e.mapping=t.mapping),t.wrapS!==void 0&&(e.wrapS=t.wrapS),t.wrapT!==void 0&&(e.wrapT=t.wrapT),t.wrapR!==void 0&&(e.wrapR=t.wrapR),t.magFilter!==void 0&&(e.magFilter=t.magFilter),t.minFilter!==void 0&&(e.minFilter=t.minFilter),t.format!==void 0&&(e.format=t.format),t.type!==void 0&&(e.type=t.type),t.anisotropy!==void 0&&(e.anisotropy=t.anisotropy),t.colorSpace!==void 0&&(e.colorSpace=t.colorSpace),t.flipY!==void 0&&(e.flipY=t.flipY),t.generateMipmaps!==void 0&&(e.generateMipmaps=t.generateMipmaps),t.mipmapsAutoUpdate!==void 0&&(e.mipmapsAutoUpdate=t.mipmapsAutoUpdate),t.internalFormat!==void 0&&(e.internalFormat=t.internalFormat);for(let n=0;n<this.textures.length;n++)this.textures[n].setValues(e)}get texture(){return this.textures[0]}set texture(t){this.textures[0]=t}set depthTexture(t){this._depthTexture!==null&&this._depthTexture.renderTarget===this&&(this._depthTexture.renderTarget=null),t!==null&&t.renderTarget===null&&(t.renderTarget=this),this._depthTexture=t}get depthTexture(){return this._depthTexture}setSize(t,e,n=1){if(this.width!==t||this.height!==e||this.depth!==n){this.width=t,this.height=e,this.depth=n;for(let s=0,r=this.textures.length;s<r;s++)this.textures[s].image.width=t,this.textures[s].image.height=e,this.textures[s].image.depth=n,this.textures[s].isData3DTexture!==!0&&(this.textures[s].isArrayTexture=this.textures[s].image.depth>1);this.dispose()}this.viewport.set(0,0,t,e),this.scissor.set(0,0,t,e)}clone(){return new this.constructor().copy(this)}copy(t){this.width=t.width,this.height=t.height,this.depth=t.depth,this.scissor.copy(t.scissor),this.scissorTest=t.scissorTest,this.viewport.copy(t.viewport),this.textures.length=0;for(let e=0,n=t.textures.length;e<n;e++){this.textures[e]=t.textures[e].clone(),this.textures[e].isRenderTargetTexture=!0,this.textures[e].renderTarget=this;let s=Object.assign({},t.textures[e].image);this.textures[e].source=new gr(s)}if(this.depthBuffer=t.depthBuffer,this.stencilBuffer=t.stencilBuffer,this.resolveColorBuffer=t.resolveColorBuffer,this.resolveDepthBuffer=t.resolveDepthBuffer,this.resolveStencilBuffer=t.resolveStencilBuffer,this.storeMultisampledColorBuffer=t.storeMultisampledColorBuffer,this.storeMultisampledDepthBuffer=t.storeMultisampledDepthBuffer,this.storeMultisampledStencilBuffer=t.storeMultisampledStencilBuffer,t.depthTexture!==null)if(t.depthTexture.renderTarget===t){let e=t.depthTexture.clone();e.renderTarget=null,this.depthTexture=e}else this.depthTexture=t.depthTexture;else this.depthTexture=null;return this.samples=t.samples,this.multiview=t.multiview,this.useArrayDepthTexture=t.useArrayDepthTexture,this}dispose(){this.dispatchEvent({type:"dispose"})}},Un=class extends yl{constructor(t=1,e=1,n={}){super(t,e,n),this.isWebGLRenderTarget=!0}},go=class extends En{constructor(t=null,e=1,n=1,s=1){super(null),this.isDataArrayTexture=!0,this.image={data:t,width:e,height:n,depth:s},this.magFilter=ye,this.minFilter=ye,this.wrapR=pi,this.generateMipmaps=!1,this.flipY=!1,this.unpackAlignment=1,this.layerUpdates=new Set}copy(t){return super.copy(t),this.wrapR=t.wrapR,this}addLayerUpdate(t){this.layerUpdates.add(t)}clearLayerUpdates(){this.layerUpdates.clear()}};var _r=class extends En{constructor(t=null,e=1,n=1,s=1){super(null),this.isData3DTexture=!0,this.image={data:t,width:e,height:n,depth:s},this.magFilter=ye,this.minFilter=ye,this.wrapR=pi,this.generateMipmaps=!1,this.flipY=!1,this.unpackAlignment=1}copy(t){return super.copy(t),this.wrapR=t.wrapR,this}};var Pt=class i{static{this.prototype.isMatrix4=!0}constructor(t,e,n,s,r,o,a,l,c,h,u,d,f,p,_,m){this.elements=[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1],t!==void 0&&this.set(t,e,n,s,r,o,a,l,c,h,u,d,f,p,_,m)}set(t,e,n,s,r,o,a,l,c,h,u,d,f,p,_,m){let g=this.elements;return g[0]=t,g[4]=e,g[8]=n,g[12]=s,g[1]=r,g[5]=o,g[9]=a,g[13]=l,g[2]=c,g[6]=h,g[10]=u,g[14]=d,g[3]=f,g[7]=p,g[11]=_,g[15]=m,this}identity(){return this.set(1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1),this}clone(){return new i().fromArray(this.elements)}copy(t){let e=this.elements,n=t.elements;return e[0]=n[0],e[1]=n[1],e[2]=n[2],e[3]=n[3],e[4]=n[4],e[5]=n[5],e[6]=n[6],e[7]=n[7],e[8]=n[8],e[9]=n[9],e[10]=n[10],e[11]=n[11],e[12]=n[12],e[13]=n[13],e[14]=n[14],e[15]=n[15],this}copyPosition(t){let e=this.elements,n=t.elements;return e[12]=n[12],e[13]=n[13],e[14]=n[14],this}setFromMatrix3(t){let e=t.elements;return this.set(e[0],e[3],e[6],0,e[1],e[4],e[7],0,e[2],e[5],e[8],0,0,0,0,1),this}extractBasis(t,e,n){return this.determinantAffine()===0?(t.set(1,0,0),e.set(0,1,0),n.set(0,0,1),this):(t.setFromMatrixColumn(this,0),e.setFromMatrixColumn(this,1),n.setFromMatrixColumn(this,2),this)}makeBasis(t,e,n){return this.set(t.x,e.x,n.x,0,t.y,e.y,n.y,0,t.z,e.z,n.z,0,0,0,0,1),this}extractRotation(t){if(t.determinantAffine()===0)return this.identity();let e=this.elements,n=t.elements,s=1/Ks.setFromMatrixColumn(t,0).length(),r=1/Ks.setFromMatrixColumn(t,1).length(),o=1/Ks.setFromMatrixColumn(t,2).length();return e[0]=n[0]*s,e[1]=n[1]*s,e[2]=n[2]*s,e[3]=0,e[4]=n[4]*r,e[5]=n[5]*r,e[6]=n[6]*r,e[7]=0,e[8]=n[8]*o,e[9]=n[9]*o,e[10]=n[10]*o,e[11]=0,e[12]=0,e[13]=0,e[14]=0,e[15]=1,this}makeRotationFromEuler(t){let e=this.elements,n=t.x,s=t.y,r=t.z,o=Math.cos(n),a=Math.sin(n),l=Math.cos(s),c=Math.sin(s),h=Math.cos(r),u=Math.sin(r);if(t.order==="XYZ"){let d=o*h,f=o*u,p=a*h,_=a*u;e[0]=l*h,e[4]=-l*u,e[8]=c,e[1]=f+p*c,e[5]=d-_*c,e[9]=-a*l,e[2]=_-d*c,e[6]=p+f*c,e[10]=o*l}else if(t.order==="YXZ"){let d=l*h,f=l*u,p=c*h,_=c*u;e[0]=d+_*a,e[4]=p*a-f,e[8]=o*c,e[1]=o*u,e[5]=o*h,e[9]=-a,e[2]=f*a-p,e[6]=_+d*a,e[10]=o*l}else if(t.order==="ZXY"){let d=l*h,f=l*u,p=c*h,_=c*u;e[0]=d-_*a,e[4]=-o*u,e[8]=p+f*a,e[1]=f+p*a,e[5]=o*h,e[9]=_-d*a,e[2]=-o*c,e[6]=a,e[10]=o*l}else if(t.order==="ZYX"){let d=o*h,f=o*u,p=a*h,_=a*u;e[0]=l*h,e[4]=p*c-f,e[8]=d*c+_,e[1]=l*u,e[5]=_*c+d,e[9]=f*c-p,e[2]=-c,e[6]=a*l,e[10]=o*l}else if(t.order==="YZX"){let d=o*l,f=o*c,p=a*l,_=a*c;e[0]=l*h,e[4]=_-d*u,e[8]=p*u+f,e[1]=u,e[5]=o*h,e[9]=-a*h,e[2]=-c*h,e[6]=f*u+p,e[10]=d-_*u}else if(t.order==="XZY"){let d=o*l,f=o*c,p=a*l,_=a*c;e[0]=l*h,e[4]=-u,e[8]=c*h,e[1]=d*u+_,e[5]=o*h,e[9]=f*u-p,e[2]=p*u-f,e[6]=a*h,e[10]=_*u+d}return e[3]=0,e[7]=0,e[11]=0,e[12]=0,e[13]=0,e[14]=0,e[15]=1,this}makeRotationFromQuaternion(t){return this.compose(d_,t,f_)}lookAt(t,e,n){let s=this.elements;return Dn.subVectors(t,e),Dn.lengthSq()===0&&(Dn.z=1),Dn.normalize(),ts.crossVectors(n,Dn),ts.lengthSq()===0&&(Math.abs(n.z)===1?Dn.x+=1e-4:Dn.z+=1e-4,Dn.normalize(),ts.crossVectors(n,Dn)),ts.normalize(),Ia.crossVectors(Dn,ts),s[0]=ts.x,s[4]=Ia.x,s[8]=Dn.x,s[1]=ts.y,s[5]=Ia.y,s[9]=Dn.y,s[2]=ts.z,s[6]=Ia.z,s[10]=Dn.z,this}multiply(t){return this.multiplyMatrices(this,t)}premultiply(t){return this.multiplyMatrices(t,this)}multiplyMatrices(t,e){let n=t.elements,s=e.elements,r=this.elements,o=n[0],a=n[4],l=n[8],c=n[12],h=n[1],u=n[5],d=n[9],f=n[13],p=n[2],_=n[6],m=n[10],g=n[14],y=n[3],b=n[7],v=n[11],M=n[15],A=s[0],x=s[4],w=s[8],D=s[12],R=s[1],N=s[5],P=s[9],U=s[13],L=s[2],k=s[6],z=s[10],W=s[14],et=s[3],X=s[7],Q=s[11],tt=s[15];return r[0]=o*A+a*R+l*L+c*et,r[4]=o*x+a*N+l*k+c*X,r[8]=o*w+a*P+l*z+c*Q,r[12]=o*D+a*U+l*W+c*tt,r[1]=h*A+u*R+d*L+f*et,r[5]=h*x+u*N+d*k+f*X,r[9]=h*w+u*P+d*z+f*Q,r[13]=h*D+u*U+d*W+f*tt,r[2]=p*A+_*R+m*L+g*et,r[6]=p*x+_*N+m*k+g*X,r[10]=p*w+_*P+m*z+g*Q,r[14]=p*D+_*U+m*W+g*tt,r[3]=y*A+b*R+v*L+M*et,r[7]=y*x+b*N+v*k+M*X,r[11]=y*w+b*P+v*z+M*Q,r[15]=y*D+b*U+v*W+M*tt,this}multiplyScalar(t){let e=this.elements;return e[0]*=t,e[4]*=t,e[8]*=t,e[12]*=t,e[1]*=t,e[5]*=t,e[9]*=t,e[13]*=t,e[2]*=t,e[6]*=t,e[10]*=t,e[14]*=t,e[3]*=t,e[7]*=t,e[11]*=t,e[15]*=t,this}determinant(){let t=this.elements,e=t[0],n=t[4],s=t[8],r=t[12],o=t[1],a=t[5],l=t[9],c=t[13],h=t[2],u=t[6],d=t[10],f=t[14],p=t[3],_=t[7],m=t[11],g=t[15],y=l*f-c*d,b=a*f-c*u,v=a*d-l*u,M=o*f-c*h,A=o*d-l*h,x=o*u-a*h;return e*(_*y-m*b+g*v)-n*(p*y-m*M+g*A)+s*(p*b-_*M+g*x)-r*(p*v-_*A+m*x)}determinantAffine(){let t=this.elements,e=t[0],n=t[4],s=t[8],r=t[1],o=t[5],a=t[9],l=t[2],c=t[6],h=t[10];return e*(o*h-a*c)-n*(r*h-a*l)+s*(r*c-o*l)}transpose(){let t=this.elements,e;return e=t[1],t[1]=t[4],t[4]=e,e=t[2],t[2]=t[8],t[8]=e,e=t[6],t[6]=t[9],t[9]=e,e=t[3],t[3]=t[12],t[12]=e,e=t[7],t[7]=t[13],t[13]=e,e=t[11],t[11]=t[14],t[14]=e,this}setPosition(t,e,n){let s=this.elements;return t.isVector3?(s[12]=t.x,s[13]=t.y,s[14]=t.z):(s[12]=t,s[13]=e,s[14]=n),this}invert(){let t=this.elements,e=t[0],n=t[1],s=t[2],r=t[3],o=t[4],a=t[5],l=t[6],c=t[7],h=t[8],u=t[9],d=t[10],f=t[11],p=t[12],_=t[13],m=t[14],g=t[15],y=e*a-n*o,b=e*l-s*o,v=e*c-r*o,M=n*l-s*a,A=n*c-r*a,x=s*c-r*l,w=h*_-u*p,D=h*m-d*p,R=h*g-f*p,N=u*m-d*_,P=u*g-f*_,U=d*g-f*m,L=y*U-b*P+v*N+M*R-A*D+x*w;if(L===0)return this.set(0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0);let k=1/L;return t[0]=(a*U-l*P+c*N)*k,t[1]=(s*P-n*U-r*N)*k,t[2]=(_*x-m*A+g*M)*k,t[3]=(d*A-u*x-f*M)*k,t[4]=(l*R-o*U-c*D)*k,t[5]=(e*U-s*R+r*D)*k,t[6]=(m*v-p*x-g*b)*k,t[7]=(h*x-d*v+f*b)*k,t[8]=(o*P-a*R+c*w)*k,t[9]=(n*R-e*P-r*w)*k,t[10]=(p*A-_*v+g*y)*k,t[11]=(u*v-h*A-f*y)*k,t[12]=(a*D-o*N-l*w)*k,t[13]=(e*N-n*D+s*w)*k,t[14]=(_*b-p*M-m*y)*k,t[15]=(h*M-u*b+d*y)*k,this}scale(t){let e=this.elements,n=t.x,s=t.y,r=t.z;return e[0]*=n,e[4]*=s,e[8]*=r,e[1]*=n,e[5]*=s,e[9]*=r,e[2]*=n,e[6]*=s,e[10]*=r,e[3]*=n,e[7]*=s,e[11]*=r,this}getMaxScaleOnAxis(){let t=this.elements,e=t[0]*t[0]+t[1]*t[1]+t[2]*t[2],n=t[4]*t[4]+t[5]*t[5]+t[6]*t[6],s=t[8]*t[8]+t[9]*t[9]+t[10]*t[10];return Math.sqrt(Math.max(e,n,s))}makeTranslation(t,e,n){return t.isVector3?this.set(1,0,0,t.x,0,1,0,t.y,0,0,1,t.z,0,0,0,1):this.set(1,0,0,t,0,1,0,e,0,0,1,n,0,0,0,1),this}makeRotationX(t){let e=Math.cos(t),n=Math.sin(t);return this.set(1,0,0,0,0,e,-n,0,0,n,e,0,0,0,0,1),this}makeRotationY(t){let e=Math.cos(t),n=Math.sin(t);return this.set(e,0,n,0,0,1,0,0,-n,0,e,0,0,0,0,1),this}makeRotationZ(t){let e=Math.cos(t),n=Math.sin(t);return this.set(e,-n,0,0,n,e,0,0,0,0,1,0,0,0,0,1),this}makeRotationAxis(t,e){let n=Math.cos(e),s=Math.sin(e),r=1-n,o=t.x,a=t.y,l=t.z,c=r*o,h=r*a;return this.set(c*o+n,c*a-s*l,c*l+s*a,0,c*a+s*l,h*a+n,h*l-s*o,0,c*l-s*a,h*l+s*o,r*l*l+n,0,0,0,0,1),this}makeScale(t,e,n){return this.set(t,0,0,0,0,e,0,0,0,0,n,0,0,0,0,1),this}makeShear(t,e,n,s,r,o){return this.set(1,n,r,0,t,1,o,0,e,s,1,0,0,0,0,1),this}compose(t,e,n){let s=this.elements,r=e._x,o=e._y,a=e._z,l=e._w,c=r+r,h=o+o,u=a+a,d=r*c,f=r*h,p=r*u,_=o*h,m=o*u,g=a*u,y=l*c,b=l*h,v=l*u,M=n.x,A=n.y,x=n.z;return s[0]=(1-(_+g))*M,s[1]=(f+v)*M,s[2]=(p-b)*M,s[3]=0,s[4]=(f-v)*A,s[5]=(1-(d+g))*A,s[6]=(m+y)*A,s[7]=0,s[8]=(p+b)*x,s[9]=(m-y)*x,s[10]=(1-(d+_))*x,s[11]=0,s[12]=t.x,s[13]=t.y,s[14]=t.z,s[15]=1,this}decompose(t,e,n){let s=this.elements;t.x=s[12],t.y=s[13],t.z=s[14];let r=this.determinantAffine();if(r===0)return n.set(1,1,1),e.identity(),this;let o=Ks.set(s[0],s[1],s[2]).length(),a=Ks.set(s[4],s[5],s[6]).length(),l=Ks.set(s[8],s[9],s[10]).length();r<0&&(o=-o),ei.copy(this);let c=1/o,h=1/a,u=1/l;return ei.elements[0]*=c,ei.elements[1]*=c,ei.elements[2]*=c,ei.elements[4]*=h,ei.elements[5]*=h,ei.elements[6]*=h,ei.elements[8]*=u,ei.elements[9]*=u,ei.elements[10]*=u,e.setFromRotationMatrix(ei),n.x=o,n.y=a,n.z=l,this}makePerspective(t,e,n,s,r,o,a=Jn,l=!1){let c=this.elements,h=2*r/(e-t),u=2*r/(n-s),d=(e+t)/(e-t),f=(n+s)/(n-s),p,_;if(l)p=r/(o-r),_=o*r/(o-r);else if(a===Jn)p=-(o+r)/(o-r),_=-2*o*r/(o-r);else if(a===fo)p=-o/(o-r),_=-o*r/(o-r);else throw new Error("THREE.Matrix4.makePerspective(): Invalid coordinate system: "+a);return c[0]=h,c[4]=0,c[8]=d,c[12]=0,c[1]=0,c[5]=u,c[9]=f,c[13]=0,c[2]=0,c[6]=0,c[10]=p,c[14]=_,c[3]=0,c[7]=0,c[11]=-1,c[15]=0,this}makeOrthographic(t,e,n,s,r,o,a=Jn,l=!1){let c=this.elements,h=2/(e-t),u=2/(n-s),d=-(e+t)/(e-t),f=-(n+s)/(n-s),p,_;if(l)p=1/(o-r),_=o/(o-r);else if(a===Jn)p=-2/(o-r),_=-(o+r)/(o-r);else if(a===fo)p=-1/(o-r),_=-r/(o-r);else throw new Error("THREE.Matrix4.makeOrthographic(): Invalid coordinate system: "+a);return c[0]=h,c[4]=0,c[8]=0,c[12]=d,c[1]=0,c[5]=u,c[9]=0,c[13]=f,c[2]=0,c[6]=0,c[10]=p,c[14]=_,c[3]=0,c[7]=0,c[11]=0,c[15]=1,this}equals(t){let e=this.elements,n=t.elements;for(let s=0;s<16;s++)if(e[s]!==n[s])return!1;return!0}fromArray(t,e=0){for(let n=0;n<16;n++)this.elements[n]=t[n+e];return this}toArray(t=[],e=0){let n=this.elements;return t[e]=n[0],t[e+1]=n[1],t[e+2]=n[2],t[e+3]=n[3],t[e+4]=n[4],t[e+5]=n[5],t[e+6]=n[6],t[e+7]=n[7],t[e+8]=n[8],t[e+9]=n[9],t[e+10]=n[10],t[e+11]=n[11],t[e+12]=n[12],t[e+13]=n[13],t[e+14]=n[14],t[e+15]=n[15],t}},Ks=new C,ei=new Pt,d_=new C(0,0,0),f_=new C(1,1,1),ts=new C,Ia=new C,Dn=new C,op=new Pt,ap=new Oe,rs=class i{constructor(t=0,e=0,n=0,s=i.DEFAULT_ORDER){this.isEuler=!0,this._x=t,this._y=e,this._z=n,this._order=s}get x(){return this._x}set x(t){this._x=t,this._onChangeCallback()}get y(){return this._y}set y(t){this._y=t,this._onChangeCallback()}get z(){return this._z}set z(t){this._z=t,this._onChangeCallback()}get order(){return this._order}set order(t){this._order=t,this._onChangeCallback()}set(t,e,n,s=this._order){return this._x=t,this._y=e,this._z=n,this._order=s,this._onChangeCallback(),this}clone(){return new this.constructor(this._x,this._y,this._z,this._order)}copy(t){return this._x=t._x,this._y=t._y,this._z=t._z,this._order=t._order,this._onChangeCallback(),this}setFromRotationMatrix(t,e=this._order,n=!0){let s=t.elements,r=s[0],o=s[4],a=s[8],l=s[1],c=s[5],h=s[9],u=s[2],d=s[6],f=s[10];switch(e){case"XYZ":this._y=Math.asin(Vt(a,-1,1)),Math.abs(a)<.9999999?(this._x=Math.atan2(-h,f),this._z=Math.atan2(-o,r)):(this._x=Math.atan2(d,c),this._z=0);break;case"YXZ":this._x=Math.asin(-Vt(h,-1,1)),Math.abs(h)<.9999999?(this._y=Math.atan2(a,f),this._z=Math.atan2(l,c)):(this._y=Math.atan2(-u,r),this._z=0);break;case"ZXY":this._x=Math.asin(Vt(d,-1,1)),Math.abs(d)<.9999999?(this._y=Math.atan2(-u,f),this._z=Math.atan2(-o,c)):(this._y=0,this._z=Math.atan2(l,r));break;case"ZYX":this._y=Math.asin(-Vt(u,-1,1)),Math.abs(u)<.9999999?(this._x=Math.atan2(d,f),this._z=Math.atan2(l,r)):(this._x=0,this._z=Math.atan2(-o,c));break;case"YZX":this._z=Math.asin(Vt(l,-1,1)),Math.abs(l)<.9999999?(this._x=Math.atan2(-h,c),this._y=Math.atan2(-u,r)):(this._x=0,this._y=Math.atan2(a,f));break;case"XZY":this._z=Math.asin(-Vt(o,-1,1)),Math.abs(o)<.9999999?(this._x=Math.atan2(d,c),this._y=Math.atan2(a,r)):(this._x=Math.atan2(-h,f),this._y=0);break;default:It("Euler: .setFromRotationMatrix() encountered an unknown order: "+e)}return this._order=e,n===!0&&this._onChangeCallback(),this}setFromQuaternion(t,e,n){return op.makeRotationFromQuaternion(t),this.setFromRotationMatrix(op,e,n)}setFromVector3(t,e=this._order){return this.set(t.x,t.y,t.z,e)}reorder(t){return ap.setFromEuler(this),this.setFromQuaternion(ap,t)}equals(t){return t._x===this._x&&t._y===this._y&&t._z===this._z&&t._order===this._order}fromArray(t){return this._x=t[0],this._y=t[1],this._z=t[2],t[3]!==void 0&&(this._order=t[3]),this._onChangeCallback(),this}toArray(t=[],e=0){return t[e]=this._x,t[e+1]=this._y,t[e+2]=this._z,t[e+3]=this._order,t}_onChange(t){return this._onChangeCallback=t,this}_onChangeCallback(){}*[Symbol.iterator](){yield this._x,yield this._y,yield this._z,yield this._order}};rs.DEFAULT_ORDER="XYZ";var yr=class{constructor(){this.mask=1}set(t){this.mask=(1<<t|0)>>>0}enable(t){this.mask|=1<<t|0}enableAll(){this.mask=-1}toggle(t){this.mask^=1<<t|0}disable(t){this.mask&=~(1<<t|0)}disableAll(){this.mask=0}test(t){return(this.mask&t.mask)!==0}isEnabled(t){return(this.mask&(1<<t|0))!==0}},p_=0,lp=new C,js=new Oe,Ei=new Pt,La=new C,no=new C,m_=new C,g_=new Oe,cp=new C(1,0,0),hp=new C(0,1,0),up=new C(0,0,1),dp={type:"added"},__={type:"removed"},Qs={type:"childadded",child:null},Wh={type:"childremoved",child:null},Tn=class i extends si{constructor(){super(),this.isObject3D=!0,Object.defineProperty(this,"id",{value:p_++}),this.uuid=fs(),this.name="",this.type="Object3D",this.parent=null,this.children=[],this.up=i.DEFAULT_UP.clone();let t=new C,e=new rs,n=new Oe,s=new C(1,1,1);function r(){n.setFromEuler(e,!1)}function o(){e.setFromQuaternion(n,void 0,!1)}e._onChange(r),n._onChange(o),Object.defineProperties(this,{position:{configurable:!0,enumerable:!0,value:t},rotation:{configurable:!0,enumerable:!0,value:e},quaternion:{configurable:!0,enumerable:!0,value:n},scale:{configurable:!0,enumerable:!0,value:s},modelViewMatrix:{value:new Pt},normalMatrix:{value:new Ut}}),this.matrix=new Pt,this.matrixWorld=new Pt,this.matrixAutoUpdate=i.DEFAULT_MATRIX_AUTO_UPDATE,this.matrixWorldAutoUpdate=i.DEFAULT_MATRIX_WORLD_AUTO_UPDATE,this.matrixWorldNeedsUpdate=!1,this.layers=new yr,this.visible=!0,this.castShadow=!1,this.receiveShadow=!1,this.frustumCulled=!0,this.renderOrder=0,this.animations=[],this.customDepthMaterial=void 0,this.customDistanceMaterial=void 0,this.static=!1,this.userData={},this.pivot=null}onBeforeShadow(){}onAfterShadow(){}onBeforeRender(){}onAfterRender(){}applyMatrix4(t){this.matrixAutoUpdate&&this.updateMatrix(),this.matrix.premultiply(t),this.matrix.decompose(this.position,this.quaternion,this.scale),this.pivot!==null&&this.position.copy(this.pivot).applyMatrix4(this.matrix).sub(this.pivot)}applyQuaternion(t){return this.quaternion.premultiply(t),this}setRotationFromAxisAngle(t,e){this.quaternion.setFromAxisAngle(t,e)}setRotationFromEuler(t){this.quaternion.setFromEuler(t,!0)}setRotationFromMatrix(t){this.quaternion.setFromRotationMatrix(t)}setRotationFromQuaternion(t){this.quaternion.copy(t)}rotateOnAxis(t,e){return js.setFromAxisAngle(t,e),this.quaternion.multiply(js),this}rotateOnWorldAxis(t,e){return js.setFromAxisAngle(t,e),this.quaternion.premultiply(js),this}rotateX(t){return this.rotateOnAxis(cp,t)}rotateY(t){return this.rotateOnAxis(hp,t)}rotateZ(t){return this.rotateOnAxis(up,t)}translateOnAxis(t,e){return lp.copy(t).applyQuaternion(this.quaternion),this.position.add(lp.multiplyScalar(e)),this}translateX(t){return this.translateOnAxis(cp,t)}translateY(t){return this.translateOnAxis(hp,t)}translateZ(t){return this.translateOnAxis(up,t)}localToWorld(t){return this.updateWorldMatrix(!0,!1),t.applyMatrix4(this.matrixWorld)}worldToLocal(t){return this.updateWorldMatrix(!0,!1),t.applyMatrix4(Ei.copy(this.matrixWorld).invert())}lookAt(t,e,n){t.isVector3?La.copy(t):La.set(t,e,n);let s=this.parent;this.updateWorldMatrix(!0,!1),no.setFromMatrixPosition(this.matrixWorld),this.isCamera||this.isLight?Ei.lookAt(no,La,this.up):Ei.lookAt(La,no,this.up),this.quaternion.setFromRotationMatrix(Ei),s&&(Ei.extractRotation(s.matrixWorld),js.setFromRotationMatrix(Ei),this.quaternion.premultiply(js.invert()))}add(t){if(arguments.length>1){for(let e=0;e<arguments.length;e++)this.add(arguments[e]);return this}return t===this?(Nt("Object3D.add: object can't be added as a child of itself.",t),this):(t&&t.isObject3D?(t.removeFromParent(),t.parent=this,this.children.push(t),t.dispatchEvent(dp),Qs.child=t,this.dispatchEvent(Qs),Qs.child=null):Nt("Object3D.add: object not an instance of THREE.Object3D.",t),this)}remove(t){if(arguments.length>1){for(let n=0;n<arguments.length;n++)this.remove(arguments[n]);return this}let e=this.children.indexOf(t);return e!==-1&&(t.parent=null,this.children.splice(e,1),t.dispatchEvent(__),Wh.child=t,this.dispatchEvent(Wh),Wh.child=null),this}removeFromParent(){let t=this.parent;return t!==null&&t.remove(this),this}clear(){return this.remove(...this.children)}attach(t){return this.updateWorldMatrix(!0,!1),Ei.copy(this.matrixWorld).invert(),t.parent!==null&&(t.parent.updateWorldMatrix(!0,!1),Ei.multiply(t.parent.matrixWorld)),t.applyMatrix4(Ei),t.removeFromParent(),t.parent=this,this.children.push(t),t.updateWorldMatrix(!1,!0),t.dispatchEvent(dp),Qs.child=t,this.dispatchEvent(Qs),Qs.child=null,this}getObjectById(t){return this.getObjectByProperty("id",t)}getObjectByName(t){return this.getObjectByProperty("name",t)}getObjectByProperty(t,e){if(this[t]===e)return this;for(let n=0,s=this.children.length;n<s;n++){let o=this.children[n].getObjectByProperty(t,e);if(o!==void 0)return o}}getObjectsByProperty(t,e,n=[]){this[t]===e&&n.push(this);let s=this.children;for(let r=0,o=s.length;r<o;r++)s[r].getObjectsByProperty(t,e,n);return n}getWorldPosition(t){return this.updateWorldMatrix(!0,!1),t.setFromMatrixPosition(this.matrixWorld)}getWorldQuaternion(t){return this.updateWorldMatrix(!0,!1),this.matrixWorld.decompose(no,t,m_),t}getWorldScale(t){return this.updateWorldMatrix(!0,!1),this.matrixWorld.decompose(no,g_,t),t}getWorldDirection(t){this.updateWorldMatrix(!0,!1);let e=this.matrixWorld.elements;return t.set(e[8],e[9],e[10]).normalize()}raycast(){}intersectsFrustum(){return!0}traverse(t){t(this);let e=this.children;for(let n=0,s=e.length;n<s;n++)e[n].traverse(t)}traverseVisible(t){if(this.visible===!1)return;t(this);let e=this.children;for(let n=0,s=e.length;n<s;n++)e[n].traverseVisible(t)}traverseAncestors(t){let e=this.parent;e!==null&&(t(e),e.traverseAncestors(t))}updateMatrix(){this.matrix.compose(this.position,this.quaternion,this.scale);let t=this.pivot;if(t!==null){let e=t.x,n=t.y,s=t.z,r=this.matrix.elements;r[12]+=e-r[0]*e-r[4]*n-r[8]*s,r[13]+=n-r[1]*e-r[5]*n-r[9]*s,r[14]+=s-r[2]*e-r[6]*n-r[10]*s}this.matrixWorldNeedsUpdate=!0}updateMatrixWorld(t){this.matrixAutoUpdate&&this.updateMatrix(),(this.matrixWorldNeedsUpdate||t)&&(this.matrixWorldAutoUpdate===!0&&(this.parent===null?this.matrixWorld.copy(this.matrix):this.matrixWorld.multiplyMatrices(this.parent.matrixWorld,this.matrix)),this.matrixWorldNeedsUpdate=!1,t=!0);let e=this.children;for(let n=0,s=e.length;n<s;n++)e[n].updateMatrixWorld(t)}updateWorldMatrix(t,e,n=!1){let s=this.parent;if(t===!0&&s!==null&&s.updateWorldMatrix(!0,!1),this.matrixAutoUpdate&&this.updateMatrix(),(this.matrixWorldNeedsUpdate||n)&&(this.matrixWorldAutoUpdate===!0&&(this.parent===null?this.matrixWorld.copy(this.matrix):this.matrixWorld.multiplyMatrices(this.parent.matrixWorld,this.matrix)),this.matrixWorldNeedsUpdate=!1,n=!0),e===!0){let r=this.children;for(let o=0,a=r.length;o<a;o++)r[o].updateWorldMatrix(!1,!0,n)}}toJSON(t){let e=t===void 0||typeof t=="string",n={};e&&(t={geometries:{},materials:{},textures:{},images:{},shapes:{},skeletons:{},animations:{},nodes:{}},n.metadata={version:4.7,type:"Object",generator:"Object3D.toJSON"});let s={};s.uuid=this.uuid,s.type=this.type,s.name=this.name,s.castShadow=this.castShadow,s.receiveShadow=this.receiveShadow,s.visible=this.visible,s.frustumCulled=this.frustumCulled,s.renderOrder=this.renderOrder,s.static=this.static,s.matrixAutoUpdate=this.matrixAutoUpdate,Object.keys(this.userData).length>0&&(s.userData=this.userData),s.layers=this.layers.mask,s.matrix=this.matrix.toArray(),s.up=this.up.toArray(),this.pivot!==null&&(s.pivot=this.pivot.toArray()),this.morphTargetDictionary!==void 0&&(s.morphTargetDictionary=Object.assign({},this.morphTargetDictionary)),this.morphTargetInfluences!==void 0&&(s.morphTargetInfluences=this.morphTargetInfluences.slice()),this.isInstancedMesh&&(s.type="InstancedMesh",s.count=this.count,s.instanceMatrix=this.instanceMatrix.toJSON(),this.instanceColor!==null&&(s.instanceColor=this.instanceColor.toJSON())),this.isBatchedMesh&&(s.type="BatchedMesh",s.perObjectFrustumCulled=this.perObjectFrustumCulled,s.sortObjects=this.sortObjects,s.drawRanges=this._drawRanges,s.reservedRanges=this._reservedRanges,s.geometryInfo=this._geometryInfo.map(a=>({...a,boundingBox:a.boundingBox?a.boundingBox.toJSON():void 0,boundingSphere:a.boundingSphere?a.boundingSphere.toJSON():void 0})),s.instanceInfo=this._instanceInfo.map(a=>({...a})),s.availableInstanceIds=this._availableInstanceIds.slice(),s.availableGeometryIds=this._availableGeometryIds.slice(),s.nextIndexStart=this._nextIndexStart,s.nextVertexStart=this._nextVertexStart,s.geometryCount=this._geometryCount,s.maxInstanceCount=this._maxInstanceCount,s.maxVertexCount=this._maxVertexCount,s.maxIndexCount=this._maxIndexCount,s.geometryInitialized=this._geometryInitialized,s.matricesTexture=this._matricesTexture.toJSON(t),s.indirectTexture=this._indirectTexture.toJSON(t),this._colorsTexture!==null&&(s.colorsTexture=this._colorsTexture.toJSON(t)),this.boundingSphere!==null&&(s.boundingSphere=this.boundingSphere.toJSON()),this.boundingBox!==null&&(s.boundingBox=this.boundingBox.toJSON()));function r(a,l){return a[l.uuid]===void 0&&(a[l.uuid]=l.toJSON(t)),l.uuid}if(this.isScene)this.background&&(this.background.isColor?s.background=this.background.toJSON():this.background.isTexture&&(s.background=this.background.toJSON(t).uuid)),this.environment&&this.environment.isTexture&&this.environment.isRenderTargetTexture!==!0&&(s.environment=this.environment.toJSON(t).uuid);else if(this.isMesh||this.isLine||this.isPoints){s.geometry=r(t.geometries,this.geometry);let a=this.geometry.parameters;if(a!==void 0&&a.shapes!==void 0){let l=a.shapes;if(Array.isArray(l))for(let c=0,h=l.length;c<h;c++){let u=l[c];r(t.shapes,u)}else r(t.shapes,l)}}if(this.isSkinnedMesh&&(s.bindMode=this.bindMode,s.bindMatrix=this.bindMatrix.toArray(),this.skeleton!==void 0&&(r(t.skeletons,this.skeleton),s.skeleton=this.skeleton.uuid)),this.material!==void 0)if(Array.isArray(this.material)){let a=[];for(let l=0,c=this.material.length;l<c;l++)a.push(r(t.materials,this.material[l]));s.material=a}else s.material=r(t.materials,this.material);if(this.children.length>0){s.children=[];for(let a=0;a<this.children.length;a++)s.children.push(this.children[a].toJSON(t).object)}if(this.animations.length>0){s.animations=[];for(let a=0;a<this.animations.length;a++){let l=this.animations[a];s.animations.push(r(t.animations,l))}}if(e){let a=o(t.geometries),l=o(t.materials),c=o(t.textures),h=o(t.images),u=o(t.shapes),d=o(t.skeletons),f=o(t.animations),p=o(t.nodes);a.length>0&&(n.geometries=a),l.length>0&&(n.materials=l),c.length>0&&(n.textures=c),h.length>0&&(n.images=h),u.length>0&&(n.shapes=u),d.length>0&&(n.skeletons=d),f.length>0&&(n.animations=f),p.length>0&&(n.nodes=p)}return n.object=s,n;function o(a){let l=[];for(let c in a){let h=a[c];delete h.metadata,l.push(h)}return l}}clone(t){return new this.constructor().copy(this,t)}copy(t,e=!0){if(this.name=t.name,this.up.copy(t.up),this.position.copy(t.position),this.rotation.order=t.rotation.order,this.quaternion.copy(t.quaternion),this.scale.copy(t.scale),this.pivot=t.pivot!==null?t.pivot.clone():null,this.matrix.copy(t.matrix),this.matrixWorld.copy(t.matrixWorld),this.matrixAutoUpdate=t.matrixAutoUpdate,this.matrixWorldAutoUpdate=t.matrixWorldAutoUpdate,this.matrixWorldNeedsUpdate=t.matrixWorldNeedsUpdate,this.layers.mask=t.layers.mask,this.visible=t.visible,this.castShadow=t.castShadow,this.receiveShadow=t.receiveShadow,this.frustumCulled=t.frustumCulled,this.renderOrder=t.renderOrder,this.static=t.static,this.animations=t.animations.slice(),this.userData=JSON.parse(JSON.stringify(t.userData)),e===!0)for(let n=0;n<t.children.length;n++){let s=t.children[n];this.add(s.clone())}return this}dispose(){this.dispatchEvent({type:"dispose"})}};Tn.DEFAULT_UP=new C(0,1,0);Tn.DEFAULT_MATRIX_AUTO_UPDATE=!0;Tn.DEFAULT_MATRIX_WORLD_AUTO_UPDATE=!0;var ze=class extends Tn{constructor(){super(),this.isGroup=!0,this.type="Group"}},y_={type:"move"},xr=class{constructor(){this._targetRay=null,this._grip=null,this._hand=null}getHandSpace(){return this._hand===null&&(this._hand=new ze,this._hand.matrixAutoUpdate=!1,this._hand.visible=!1,this._hand.joints={},this._hand.inputState={pinching:!1}),this._hand}getTargetRaySpace(){return this._targetRay===null&&(this._targetRay=new ze,this._targetRay.matrixAutoUpdate=!1,this._targetRay.visible=!1,this._targetRay.hasLinearVelocity=!1,this._targetRay.linearVelocity=new C,this._targetRay.hasAngularVelocity=!1,this._targetRay.angularVelocity=new C),this._targetRay}getGripSpace(){return this._grip===null&&(this._grip=new ze,this._grip.matrixAutoUpdate=!1,this._grip.visible=!1,this._grip.hasLinearVelocity=!1,this._grip.linearVelocity=new C,this._grip.hasAngularVelocity=!1,this._grip.angularVelocity=new C,this._grip.eventsEnabled=!1),this._grip}dispatchEvent(t){return this._targetRay!==null&&this._targetRay.dispatchEvent(t),this._grip!==null&&this._grip.dispatchEvent(t),this._hand!==null&&this._hand.dispatchEvent(t),this}connect(t){if(t&&t.hand){let e=this._hand;if(e)for(let n of t.hand.values())this._getHandJoint(e,n)}return this.dispatchEvent({type:"connected",data:t}),this}disconnect(t){return this.dispatchEvent({type:"disconnected",data:t}),this._targetRay!==null&&(this._targetRay.visible=!1),this._grip!==null&&(this._grip.visible=!1),this._hand!==null&&(this._hand.visible=!1),this}update(t,e,n){let s=null,r=null,o=null,a=this._targetRay,l=this._grip,c=this._hand;if(t&&e.session.visibilityState!=="visible-blurred"){if(c&&t.hand){o=!0;for(let _ of t.hand.values()){let m=e.getJointPose(_,n),g=this._getHandJoint(c,_);m!==null&&(g.matrix.fromArray(m.transform.matrix),g.matrix.decompose(g.position,g.quaternion,g.scale),g.matrixWorldNeedsUpdate=!0,g.jointRadius=m.radius),g.visible=m!==null}let h=c.joints["index-finger-tip"],u=c.joints["thumb-tip"],d=h.position.distanceTo(u.position),f=.02,p=.005;c.inputState.pinching&&d>f+p?(c.inputState.pinching=!1,this.dispatchEvent({type:"pinchend",handedness:t.handedness,target:this})):!c.inputState.pinching&&d<=f-p&&(c.inputState.pinching=!0,this.dispatchEvent({type:"pinchstart",handedness:t.handedness,target:this}))}else l!==null&&t.gripSpace&&(r=e.getPose(t.gripSpace,n),r!==null&&(l.matrix.fromArray(r.transform.matrix),l.matrix.decompose(l.position,l.quaternion,l.scale),l.matrixWorldNeedsUpdate=!0,r.linearVelocity?(l.hasLinearVelocity=!0,l.linearVelocity.copy(r.linearVelocity)):l.hasLinearVelocity=!1,r.angularVelocity?(l.hasAngularVelocity=!0,l.angularVelocity.copy(r.angularVelocity)):l.hasAngularVelocity=!1,l.eventsEnabled&&l.dispatchEvent({type:"gripUpdated",data:t,target:this})));a!==null&&(s=e.getPose(t.targetRaySpace,n),s===null&&r!==null&&(s=r),s!==null&&(a.matrix.fromArray(s.transform.matrix),a.matrix.decompose(a.position,a.quaternion,a.scale),a.matrixWorldNeedsUpdate=!0,s.linearVelocity?(a.hasLinearVelocity=!0,a.linearVelocity.copy(s.linearVelocity)):a.hasLinearVelocity=!1,s.angularVelocity?(a.hasAngularVelocity=!0,a.angularVelocity.copy(s.angularVelocity)):a.hasAngularVelocity=!1,this.dispatchEvent(y_)))}return a!==null&&(a.visible=s!==null),l!==null&&(l.visible=r!==null),c!==null&&(c.visible=o!==null),this}_getHandJoint(t,e){if(t.joints[e.jointName]===void 0){let n=new ze;n.matrixAutoUpdate=!1,n.visible=!1,t.joints[e.jointName]=n,t.add(n)}return t.joints[e.jointName]}},mm={aliceblue:15792383,antiquewhite:16444375,aqua:65535,aquamarine:8388564,azure:15794175,beige:16119260,bisque:16770244,black:0,blanchedalmond:16772045,blue:255,blueviolet:9055202,brown:10824234,burlywood:14596231,cadetblue:6266528,chartreuse:8388352,chocolate:13789470,coral:16744272,cornflowerblue:6591981,cornsilk:16775388,crimson:14423100,cyan:65535,darkblue:139,darkcyan:35723,darkgoldenrod:12092939,darkgray:11119017,darkgreen:25600,darkgrey:11119017,darkkhaki:12433259,darkmagenta:9109643,darkolivegreen:5597999,darkorange:16747520,darkorchid:10040012,darkred:9109504,darksalmon:15308410,darkseagreen:9419919,darkslateblue:4734347,darkslategray:3100495,darkslategrey:3100495,darkturquoise:52945,darkviolet:9699539,deeppink:16716947,deepskyblue:49151,dimgray:6908265,dimgrey:6908265,dodgerblue:2003199,firebrick:11674146,floralwhite:16775920,forestgreen:2263842,fuchsia:16711935,gainsboro:14474460,ghostwhite:16316671,gold:16766720,goldenrod:14329120,gray:8421504,green:32768,greenyellow:11403055,grey:8421504,honeydew:15794160,hotpink:16738740,indianred:13458524,indigo:4915330,ivory:16777200,khaki:15787660,lavender:15132410,lavenderblush:16773365,lawngreen:8190976,lemonchiffon:16775885,lightblue:11393254,lightcoral:15761536,lightcyan:14745599,lightgoldenrodyellow:16448210,lightgray:13882323,lightgreen:9498256,lightgrey:13882323,lightpink:16758465,lightsalmon:16752762,lightseagreen:2142890,lightskyblue:8900346,lightslategray:7833753,lightslategrey:7833753,lightsteelblue:11584734,lightyellow:16777184,lime:65280,limegreen:3329330,linen:16445670,magenta:16711935,maroon:8388608,mediumaquamarine:6737322,mediumblue:205,mediumorchid:12211667,mediumpurple:9662683,mediumseagreen:3978097,mediumslateblue:8087790,mediumspringgreen:64154,mediumturquoise:4772300,mediumvioletred:13047173,midnightblue:1644912,mintcream:16121850,mistyrose:16770273,moccasin:16770229,navajowhite:16768685,navy:128,oldlace:16643558,olive:8421376,olivedrab:7048739,orange:16753920,orangered:16729344,orchid:14315734,palegoldenrod:15657130,palegreen:10025880,paleturquoise:11529966,palevioletred:14381203,papayawhip:16773077,peachpuff:16767673,peru:13468991,pink:16761035,plum:14524637,powderblue:11591910,purple:8388736,rebeccapurple:6697881,red:16711680,rosybrown:12357519,royalblue:4286945,saddlebrown:9127187,salmon:16416882,sandybrown:16032864,seagreen:3050327,seashell:16774638,sienna:10506797,silver:12632256,skyblue:8900331,slateblue:6970061,slategray:7372944,slategrey:7372944,snow:16775930,springgreen:65407,steelblue:4620980,tan:13808780,teal:32896,thistle:14204888,tomato:16737095,turquoise:4251856,violet:15631086,wheat:16113331,white:16777215,whitesmoke:16119285,yellow:16776960,yellowgreen:10145074},es={h:0,s:0,l:0},Da={h:0,s:0,l:0};function $h(i,t,e){return e<0&&(e+=1),e>1&&(e-=1),e<1/6?i+(t-i)*6*e:e<1/2?t:e<2/3?i+(t-i)*6*(2/3-e):i}var Kt=class{constructor(t,e,n){return this.isColor=!0,this.r=1,this.g=1,this.b=1,this.set(t,e,n)}set(t,e,n){if(e===void 0&&n===void 0){let s=t;s&&s.isColor?this.copy(s):typeof s=="number"?this.setHex(s):typeof s=="string"&&this.setStyle(s)}else this.setRGB(t,e,n);return this}setScalar(t){return this.r=t,this.g=t,this.b=t,this}setHex(t,e=Fn){return t=Math.floor(t),this.r=(t>>16&255)/255,this.g=(t>>8&255)/255,this.b=(t&255)/255,Jt.colorSpaceToWorking(this,e),this}setRGB(t,e,n,s=Jt.workingColorSpace){return this.r=t,this.g=e,this.b=n,Jt.colorSpaceToWorking(this,s),this}setHSL(t,e,n,s=Jt.workingColorSpace){if(t=Gu(t,1),e=Vt(e,0,1),n=Vt(n,0,1),e===0)this.r=this.g=this.b=n;else{let r=n<=.5?n*(1+e):n+e-n*e,o=2*n-r;this.r=$h(o,r,t+1/3),this.g=$h(o,r,t),this.b=$h(o,r,t-1/3)}return Jt.colorSpaceToWorking(this,s),this}setStyle(t,e=Fn){function n(r){r!==void 0&&parseFloat(r)<1&&It("Color: Alpha component of "+t+" will be ignored.")}let s;if(s=/^(\w+)\(([^\)]*)\)/.exec(t)){let r,o=s[1],a=s[2];switch(o){case"rgb":case"rgba":if(r=/^\s*(\d+)\s*,\s*(\d+)\s*,\s*(\d+)\s*(?:,\s*(\d+(?:\.\d+)?|\.\d+)\s*)?$/.exec(a))return n(r[4]),this.setRGB(Math.min(255,parseInt(r[1],10))/255,Math.min(255,parseInt(r[2],10))/255,Math.min(255,parseInt(r[3],10))/255,e);if(r=/^\s*(\d+(?:\.\d+)?|\.\d+)\%\s*,\s*(\d+(?:\.\d+)?|\.\d+)\%\s*,\s*(\d+(?:\.\d+)?|\.\d+)\%\s*(?:,\s*(\d+(?:\.\d+)?|\.\d+)\s*)?$/.exec(a))return n(r[4]),this.setRGB(Math.min(100,parseFloat(r[1]))/100,Math.min(100,parseFloat(r[2]))/100,Math.min(100,parseFloat(r[3]))/100,e);break;case"hsl":case"hsla":if(r=/^\s*([+-]?(?:\d+(?:\.\d+)?|\.\d+))\s*,\s*(\d+(?:\.\d+)?|\.\d+)\%\s*,\s*(\d+(?:\.\d+)?|\.\d+)\%\s*(?:,\s*(\d+(?:\.\d+)?|\.\d+)\s*)?$/.exec(a))return n(r[4]),this.setHSL(parseFloat(r[1])/360,parseFloat(r[2])/100,parseFloat(r[3])/100,e);break;default:It("Color: Unknown color model "+t)}}else if(s=/^\#([A-Fa-f\d]+)$/.exec(t)){let r=s[1],o=r.length;if(o===3)return this.setRGB(parseInt(r.charAt(0),16)/15,parseInt(r.charAt(1),16)/15,parseInt(r.charAt(2),16)/15,e);if(o===6)return this.setHex(parseInt(r,16),e);It("Color: Invalid hex color "+t)}else if(t&&t.length>0)return this.setColorName(t,e);return this}setColorName(t,e=Fn){let n=mm[t.toLowerCase()];return n!==void 0?this.setHex(n,e):It("Color: Unknown color "+t),this}clone(){return new this.constructor(this.r,this.g,this.b)}copy(t){return this.r=t.r,this.g=t.g,this.b=t.b,this}copySRGBToLinear(t){return this.r=Ii(t.r),this.g=Ii(t.g),this.b=Ii(t.b),this}copyLinearToSRGB(t){return this.r=dr(t.r),this.g=dr(t.g),this.b=dr(t.b),this}convertSRGBToLinear(){return this.copySRGBToLinear(this),this}convertLinearToSRGB(){return this.copyLinearToSRGB(this),this}getHex(t=Fn){return Jt.workingToColorSpace(un.copy(this),t),Math.round(Vt(un.r*255,0,255))*65536+Math.round(Vt(un.g*255,0,255))*256+Math.round(Vt(un.b*255,0,255))}getHexString(t=Fn){return("000000"+this.getHex(t).toString(16)).slice(-6)}getHSL(t,e=Jt.workingColorSpace){Jt.workingToColorSpace(un.copy(this),e);let n=un.r,s=un.g,r=un.b,o=Math.max(n,s,r),a=Math.min(n,s,r),l,c,h=(a+o)/2;if(a===o)l=0,c=0;else{let u=o-a;switch(c=h<=.5?u/(o+a):u/(2-o-a),o){case n:l=(s-r)/u+(s<r?6:0);break;case s:l=(r-n)/u+2;break;case r:l=(n-s)/u+4;break}l/=6}return t.h=l,t.s=c,t.l=h,t}getRGB(t,e=Jt.workingColorSpace){return Jt.workingToColorSpace(un.copy(this),e),t.r=un.r,t.g=un.g,t.b=un.b,t}getStyle(t=Fn){Jt.workingToColorSpace(un.copy(this),t);let e=un.r,n=un.g,s=un.b;return t!==Fn?`color(${t} ${e.toFixed(3)} ${n.toFixed(3)} ${s.toFixed(3)})`:`rgb(${Math.round(e*255)},${Math.round(n*255)},${Math.round(s*255)})`}offsetHSL(t,e,n){return this.getHSL(es),this.setHSL(es.h+t,es.s+e,es.l+n)}add(t){return this.r+=t.r,this.g+=t.g,this.b+=t.b,this}addColors(t,e){return this.r=t.r+e.r,this.g=t.g+e.g,this.b=t.b+e.b,this}addScalar(t){return this.r+=t,this.g+=t,this.b+=t,this}sub(t){return this.r=Math.max(0,this.r-t.r),this.g=Math.max(0,this.g-t.g),this.b=Math.max(0,this.b-t.b),this}multiply(t){return this.r*=t.r,this.g*=t.g,this.b*=t.b,this}multiplyScalar(t){return this.r*=t,this.g*=t,this.b*=t,this}lerp(t,e){return this.r+=(t.r-this.r)*e,this.g+=(t.g-this.g)*e,this.b+=(t.b-this.b)*e,this}lerpColors(t,e,n){return this.r=t.r+(e.r-t.r)*n,this.g=t.g+(e.g-t.g)*n,this.b=t.b+(e.b-t.b)*n,this}lerpHSL(t,e){this.getHSL(es),t.getHSL(Da);let n=lo(es.h,Da.h,e),s=lo(es.s,Da.s,e),r=lo(es.l,Da.l,e);return this.setHSL(n,s,r),this}setFromVector3(t){return this.r=t.x,this.g=t.y,this.b=t.z,this}applyMatrix3(t){let e=this.r,n=this.g,s=this.b,r=t.elements;return this.r=r[0]*e+r[3]*n+r[6]*s,this.g=r[1]*e+r[4]*n+r[7]*s,this.b=r[2]*e+r[5]*n+r[8]*s,this}equals(t){return t.r===this.r&&t.g===this.g&&t.b===this.b}fromArray(t,e=0){return this.r=t[e],this.g=t[e+1],this.b=t[e+2],this}toArray(t=[],e=0){return t[e]=this.r,t[e+1]=this.g,t[e+2]=this.b,t}fromBufferAttribute(t,e){return this.r=t.getX(e),this.g=t.getY(e),this.b=t.getZ(e),this}toJSON(){return this.getHex()}*[Symbol.iterator](){yield this.r,yield this.g,yield this.b}},un=new Kt;Kt.NAMES=mm;var _o=class extends Tn{constructor(){super(),this.isScene=!0,this.type="Scene",this.background=null,this.environment=null,this.fog=null,this.backgroundBlurriness=0,this.backgroundIntensity=1,this.backgroundRotation=new rs,this.environmentIntensity=1,this.environmentRotation=new rs,this.overrideMaterial=null,typeof __THREE_DEVTOOLS__<"u"&&__THREE_DEVTOOLS__.dispatchEvent(new CustomEvent("observe",{detail:this}))}copy(t,e){return super.copy(t,e),this.background=t.background!==null?t.background.clone():null,this.environment=t.environment!==null?t.environment.clone():null,this.fog=t.fog!==null?t.fog.clone():null,this.backgroundBlurriness=t.backgroundBlurriness,this.backgroundIntensity=t.backgroundIntensity,this.backgroundRotation.copy(t.backgroundRotation),this.environmentIntensity=t.environmentIntensity,this.environmentRotation.copy(t.environmentRotation),this.overrideMaterial=t.overrideMaterial!==null?t.overrideMaterial.clone():null,this.matrixAutoUpdate=t.matrixAutoUpdate,this}toJSON(t){let e=super.toJSON(t);return this.fog!==null&&(e.object.fog=this.fog.toJSON()),e.object.backgroundBlurriness=this.backgroundBlurriness,e.object.backgroundIntensity=this.backgroundIntensity,e.object.backgroundRotation=this.backgroundRotation.toArray(),e.object.environmentIntensity=this.environmentIntensity,e.object.environmentRotation=this.environmentRotation.toArray(),e}},ni=new C,Ti=new C,Xh=new C,Ri=new C,tr=new C,er=new C,fp=new C,qh=new C,Yh=new C,Zh=new C,Jh=new de,Kh=new de,jh=new de,en=class i{constructor(t=new C,e=new C,n=new C){this.a=t,this.b=e,this.c=n}static getNormal(t,e,n,s){s.subVectors(n,e),ni.subVectors(t,e),s.cross(ni);let r=s.lengthSq();return r>0?s.multiplyScalar(1/Math.sqrt(r)):s.set(0,0,0)}static getBarycoord(t,e,n,s,r){ni.subVectors(s,e),Ti.subVectors(n,e),Xh.subVectors(t,e);let o=ni.dot(ni),a=ni.dot(Ti),l=ni.dot(Xh),c=Ti.dot(Ti),h=Ti.dot(Xh),u=o*c-a*a;if(u===0)return r.set(0,0,0),null;let d=1/u,f=(c*l-a*h)*d,p=(o*h-a*l)*d;return r.set(1-f-p,p,f)}static containsPoint(t,e,n,s){return this.getBarycoord(t,e,n,s,Ri)===null?!1:Ri.x>=0&&Ri.y>=0&&Ri.x+Ri.y<=1}static getInterpolation(t,e,n,s,r,o,a,l){return this.getBarycoord(t,e,n,s,Ri)===null?(l.x=0,l.y=0,"z"in l&&(l.z=0),"w"in l&&(l.w=0),null):(l.setScalar(0),l.addScaledVector(r,Ri.x),l.addScaledVector(o,Ri.y),l.addScaledVector(a,Ri.z),l)}static getInterpolatedAttribute(t,e,n,s,r,o){return Jh.setScalar(0),Kh.setScalar(0),jh.setScalar(0),Jh.fromBufferAttribute(t,e),Kh.fromBufferAttribute(t,n),jh.fromBufferAttribute(t,s),o.setScalar(0),o.addScaledVector(Jh,r.x),o.addScaledVector(Kh,r.y),o.addScaledVector(jh,r.z),o}static isFrontFacing(t,e,n,s){return ni.subVectors(n,e),Ti.subVectors(t,e),ni.cross(Ti).dot(s)<0}set(t,e,n){return this.a.copy(t),this.b.copy(e),this.c.copy(n),this}setFromPointsAndIndices(t,e,n,s){return this.a.copy(t[e]),this.b.copy(t[n]),this.c.copy(t[s]),this}setFromAttributeAndIndices(t,e,n,s){return this.a.fromBufferAttribute(t,e),this.b.fromBufferAttribute(t,n),this.c.fromBufferAttribute(t,s),this}clone(){return new this.constructor().copy(this)}copy(t){return this.a.copy(t.a),this.b.copy(t.b),this.c.copy(t.c),this}getArea(){return ni.subVectors(this.c,this.b),Ti.subVectors(this.a,this.b),ni.cross(Ti).length()*.5}getMidpoint(t){return t.addVectors(this.a,this.b).add(this.c).multiplyScalar(1/3)}getNormal(t){return i.getNormal(this.a,this.b,this.c,t)}getPlane(t){return t.setFromCoplanarPoints(this.a,this.b,this.c)}getBarycoord(t,e){return i.getBarycoord(t,this.a,this.b,this.c,e)}getInterpolation(t,e,n,s,r){return i.getInterpolation(t,this.a,this.b,this.c,e,n,s,r)}containsPoint(t){return i.containsPoint(t,this.a,this.b,this.c)}isFrontFacing(t){return i.isFrontFacing(this.a,this.b,this.c,t)}intersectsBox(t){return t.intersectsTriangle(this)}closestPointToPoint(t,e){let n=this.a,s=this.b,r=this.c,o,a;tr.subVectors(s,n),er.subVectors(r,n),qh.subVectors(t,n);let l=tr.dot(qh),c=er.dot(qh);if(l<=0&&c<=0)return e.copy(n);Yh.subVectors(t,s);let h=tr.dot(Yh),u=er.dot(Yh);if(h>=0&&u<=h)return e.copy(s);let d=l*u-h*c;if(d<=0&&l>=0&&h<=0&&l-h>0)return o=l/(l-h),e.copy(n).addScaledVector(tr,o);Zh.subVectors(t,r);let f=tr.dot(Zh),p=er.dot(Zh);if(p>=0&&f<=p)return e.copy(r);let _=f*c-l*p;if(_<=0&&c>=0&&p<=0)return a=c/(c-p),e.copy(n).addScaledVector(er,a);let m=h*p-f*u;if(m<=0&&u-h>=0&&f-p>=0)return fp.subVectors(r,s),a=(u-h)/(u-h+(f-p)),e.copy(s).addScaledVector(fp,a);let g=1/(m+_+d);return o=_*g,a=d*g,e.copy(n).addScaledVector(tr,o).addScaledVector(er,a)}equals(t){return t.a.equals(this.a)&&t.b.equals(this.b)&&t.c.equals(this.c)}},Se=class{constructor(t=new C(1/0,1/0,1/0),e=new C(-1/0,-1/0,-1/0)){this.isBox3=!0,this.min=t,this.max=e}set(t,e){return this.min.copy(t),this.max.copy(e),this}setFromArray(t){this.makeEmpty();for(let e=0,n=t.length;e<n;e+=3)this.expandByPoint(ii.fromArray(t,e));return this}setFromBufferAttribute(t){this.makeEmpty();for(let e=0,n=t.count;e<n;e++)this.expandByPoint(ii.fromBufferAttribute(t,e));return this}setFromPoints(t){this.makeEmpty();for(let e=0,n=t.length;e<n;e++)this.expandByPoint(t[e]);return this}setFromCenterAndSize(t,e){let n=ii.copy(e).multiplyScalar(.5);return this.min.copy(t).sub(n),this.max.copy(t).add(n),this}setFromObject(t,e=!1){return this.makeEmpty(),this.expandByObject(t,e)}clone(){return new this.constructor().copy(this)}copy(t){return this.min.copy(t.min),this.max.copy(t.max),this}makeEmpty(){return this.min.x=this.min.y=this.min.z=1/0,this.max.x=this.max.y=this.max.z=-1/0,this}isEmpty(){return this.max.x<this.min.x||this.max.y<this.min.y||this.max.z<this.min.z}getCenter(t){return this.isEmpty()?t.set(0,0,0):t.addVectors(this.min,this.max).multiplyScalar(.5)}getSize(t){return this.isEmpty()?t.set(0,0,0):t.subVectors(this.max,this.min)}expandByPoint(t){return this.min.min(t),this.max.max(t),this}expandByVector(t){return this.min.sub(t),this.max.add(t),this}expandByScalar(t){return this.min.addScalar(-t),this.max.addScalar(t),this}expandByObject(t,e=!1){t.updateWorldMatrix(!1,!1);let n=t.geometry;if(n!==void 0){let r=n.getAttribute("position");if(e===!0&&r!==void 0&&t.isInstancedMesh!==!0&&t.isBatchedMesh!==!0)for(let o=0,a=r.count;o<a;o++)t.isMesh===!0?t.getVertexPosition(o,ii):ii.fromBufferAttribute(r,o),ii.applyMatrix4(t.matrixWorld),this.expandByPoint(ii);else t.boundingBox!==void 0?(t.boundingBox===null&&t.computeBoundingBox(),Na.copy(t.boundingBox)):(n.boundingBox===null&&n.computeBoundingBox(),Na.copy(n.boundingBox)),Na.applyMatrix4(t.matrixWorld),this.union(Na)}let s=t.children;for(let r=0,o=s.length;r<o;r++)this.expandByObject(s[r],e);return this}containsPoint(t){return t.x>=this.min.x&&t.x<=this.max.x&&t.y>=this.min.y&&t.y<=this.max.y&&t.z>=this.min.z&&t.z<=this.max.z}containsBox(t){return this.min.x<=t.min.x&&t.max.x<=this.max.x&&this.min.y<=t.min.y&&t.max.y<=this.max.y&&this.min.z<=t.min.z&&t.max.z<=this.max.z}getParameter(t,e){return e.set((t.x-this.min.x)/(this.max.x-this.min.x),(t.y-this.min.y)/(this.max.y-this.min.y),(t.z-this.min.z)/(this.max.z-this.min.z))}intersectsBox(t){return t.max.x>=this.min.x&&t.min.x<=this.max.x&&t.max.y>=this.min.y&&t.min.y<=this.max.y&&t.max.z>=this.min.z&&t.min.z<=this.max.z}intersectsSphere(t){return this.clampPoint(t.center,ii),ii.distanceToSquared(t.center)<=t.radius*t.radius}intersectsPlane(t){let e,n;return t.normal.x>0?(e=t.normal.x*this.min.x,n=t.normal.x*this.max.x):(e=t.normal.x*this.max.x,n=t.normal.x*this.min.x),t.normal.y>0?(e+=t.normal.y*this.min.y,n+=t.normal.y*this.max.y):(e+=t.normal.y*this.max.y,n+=t.normal.y*this.min.y),t.normal.z>0?(e+=t.normal.z*this.min.z,n+=t.normal.z*this.max.z):(e+=t.normal.z*this.max.z,n+=t.normal.z*this.min.z),e<=-t.constant&&n>=-t.constant}intersectsTriangle(t){if(this.isEmpty())return!1;this.getCenter(io),Fa.subVectors(this.max,io),nr.subVectors(t.a,io),ir.subVectors(t.b,io),sr.subVectors(t.c,io),ns.subVectors(ir,nr),is.subVectors(sr,ir),Ts.subVectors(nr,sr);let e=[0,-ns.z,ns.y,0,-is.z,is.y,0,-Ts.z,Ts.y,ns.z,0,-ns.x,is.z,0,-is.x,Ts.z,0,-Ts.x,-ns.y,ns.x,0,-is.y,is.x,0,-Ts.y,Ts.x,0];return!Qh(e,nr,ir,sr,Fa)||(e=[1,0,0,0,1,0,0,0,1],!Qh(e,nr,ir,sr,Fa))?!1:(Ua.crossVectors(ns,is),e=[Ua.x,Ua.y,Ua.z],Qh(e,nr,ir,sr,Fa))}clampPoint(t,e){return e.copy(t).clamp(this.min,this.max)}distanceToPoint(t){return this.clampPoint(t,ii).distanceTo(t)}getBoundingSphere(t){return this.isEmpty()?t.makeEmpty():(this.getCenter(t.center),t.radius=this.getSize(ii).length()*.5),t}intersect(t){return this.min.max(t.min),this.max.min(t.max),this.isEmpty()&&this.makeEmpty(),this}union(t){return this.min.min(t.min),this.max.max(t.max),this}applyMatrix4(t){return this.isEmpty()?this:(Ci[0].set(this.min.x,this.min.y,this.min.z).applyMatrix4(t),Ci[1].set(this.min.x,this.min.y,this.max.z).applyMatrix4(t),Ci[2].set(this.min.x,this.max.y,this.min.z).applyMatrix4(t),Ci[3].set(this.min.x,this.max.y,this.max.z).applyMatrix4(t),Ci[4].set(this.max.x,this.min.y,this.min.z).applyMatrix4(t),Ci[5].set(this.max.x,this.min.y,this.max.z).applyMatrix4(t),Ci[6].set(this.max.x,this.max.y,this.min.z).applyMatrix4(t),Ci[7].set(this.max.x,this.max.y,this.max.z).applyMatrix4(t),this.setFromPoints(Ci),this)}translate(t){return this.min.add(t),this.max.add(t),this}equals(t){return t.min.equals(this.min)&&t.max.equals(this.max)}toJSON(){return{min:this.min.toArray(),max:this.max.toArray()}}fromJSON(t){return this.min.fromArray(t.min),this.max.fromArray(t.max),this}},Ci=[new C,new C,new C,new C,new C,new C,new C,new C],ii=new C,Na=new Se,nr=new C,ir=new C,sr=new C,ns=new C,is=new C,Ts=new C,io=new C,Fa=new C,Ua=new C,Rs=new C;function Qh(i,t,e,n,s){for(let r=0,o=i.length-3;r<=o;r+=3){Rs.fromArray(i,r);let a=s.x*Math.abs(Rs.x)+s.y*Math.abs(Rs.y)+s.z*Math.abs(Rs.z),l=t.dot(Rs),c=e.dot(Rs),h=n.dot(Rs);if(Math.max(-Math.max(l,c,h),Math.min(l,c,h))>a)return!1}return!0}var Ue=new C,Oa=new St,x_=0,Ht=class extends si{constructor(t,e,n=!1){if(super(),Array.isArray(t))throw new TypeError("THREE.BufferAttribute: array should be a Typed Array.");this.isBufferAttribute=!0,Object.defineProperty(this,"id",{value:x_++}),this.name="",this.array=t,this.itemSize=e,this.count=t!==void 0?t.length/e:0,this.normalized=n,this.usage=Vu,this.updateRanges=[],this.gpuType=Rn,this.version=0,this._normalizationScale=t!==void 0?Ac(t):void 0}onUploadCallback(){}set needsUpdate(t){t===!0&&this.version++}setUsage(t){return this.usage=t,this}addUpdateRange(t,e){this.updateRanges.push({start:t,count:e})}clearUpdateRanges(){this.updateRanges.length=0}copy(t){return this.name=t.name,this.array=new t.array.constructor(t.array),this.itemSize=t.itemSize,this.count=t.count,this.normalized=t.normalized,this.usage=t.usage,this.gpuType=t.gpuType,this._normalizationScale=t._normalizationScale,this}copyAt(t,e,n){t*=this.itemSize,n*=e.itemSize;for(let s=0,r=this.itemSize;s<r;s++)this.array[t+s]=e.array[n+s];return this}copyArray(t){return this.array.set(t),this}applyMatrix3(t){if(this.itemSize===2)for(let e=0,n=this.count;e<n;e++)Oa.fromBufferAttribute(this,e),Oa.applyMatrix3(t),this.setXY(e,Oa.x,Oa.y);else if(this.itemSize===3)for(let e=0,n=this.count;e<n;e++)Ue.fromBufferAttribute(this,e),Ue.applyMatrix3(t),this.setXYZ(e,Ue.x,Ue.y,Ue.z);return this}applyMatrix4(t){for(let e=0,n=this.count;e<n;e++)Ue.fromBufferAttribute(this,e),Ue.applyMatrix4(t),this.setXYZ(e,Ue.x,Ue.y,Ue.z);return this}applyNormalMatrix(t){for(let e=0,n=this.count;e<n;e++)Ue.fromBufferAttribute(this,e),Ue.applyNormalMatrix(t),this.setXYZ(e,Ue.x,Ue.y,Ue.z);return this}transformDirection(t){for(let e=0,n=this.count;e<n;e++)Ue.fromBufferAttribute(this,e),Ue.transformDirection(t),this.setXYZ(e,Ue.x,Ue.y,Ue.z);return this}set(t,e=0){return this.array.set(t,e),this}getComponent(t,e){let n=this.array[t*this.itemSize+e];return this.normalized&&(n=this._denormalize(n)),n}setComponent(t,e,n){return this.normalized&&(n=this._normalize(n)),this.array[t*this.itemSize+e]=n,this}getX(t){let e=this.array[t*this.itemSize];return this.normalized&&(e=this._denormalize(e)),e}setX(t,e){return this.normalized&&(e=this._normalize(e)),this.array[t*this.itemSize]=e,this}getY(t){let e=this.array[t*this.itemSize+1];return this.normalized&&(e=this._denormalize(e)),e}setY(t,e){return this.normalized&&(e=this._normalize(e)),this.array[t*this.itemSize+1]=e,this}getZ(t){let e=this.array[t*this.itemSize+2];return this.normalized&&(e=this._denormalize(e)),e}setZ(t,e){return this.normalized&&(e=this._normalize(e)),this.array[t*this.itemSize+2]=e,this}getW(t){let e=this.array[t*this.itemSize+3];return this.normalized&&(e=this._denormalize(e)),e}setW(t,e){return this.normalized&&(e=this._normalize(e)),this.array[t*this.itemSize+3]=e,this}setXY(t,e,n){return t*=this.itemSize,this.normalized&&(e=this._normalize(e),n=this._normalize(n)),this.array[t+0]=e,this.array[t+1]=n,this}setXYZ(t,e,n,s){return t*=this.itemSize,this.normalized&&(e=this._normalize(e),n=this._normalize(n),s=this._normalize(s)),this.array[t+0]=e,this.array[t+1]=n,this.array[t+2]=s,this}setXYZW(t,e,n,s,r){return t*=this.itemSize,this.normalized&&(e=this._normalize(e),n=this._normalize(n),s=this._normalize(s),r=this._normalize(r)),this.array[t+0]=e,this.array[t+1]=n,this.array[t+2]=s,this.array[t+3]=r,this}onUpload(t){return this.onUploadCallback=t,this}clone(){return new this.constructor(this.array,this.itemSize).copy(this)}toJSON(){let t={itemSize:this.itemSize,type:this.array.constructor.name,array:Array.from(this.array),normalized:this.normalized};return t.name=this.name,t.usage=this.usage,t.gpuType=this.gpuType,t}dispose(){this.dispatchEvent({type:"dispose"})}_denormalize(t){let e=this._normalizationScale;return e!==void 0?Math.max(t/e,-1):Wu(t,this.array)}_normalize(t){let e=this._normalizationScale;return e!==void 0?Math.round(t*e):$u(t,this.array)}};var yo=class extends Ht{constructor(t,e,n){super(new Uint16Array(t),e,n)}};var xo=class extends Ht{constructor(t,e,n){super(new Uint32Array(t),e,n)}};var Ze=class extends Ht{constructor(t,e,n){super(new Float32Array(t),e,n)}},v_=new Se,so=new C,tu=new C,os=class{constructor(t=new C,e=-1){this.isSphere=!0,this.center=t,this.radius=e}set(t,e){return this.center.copy(t),this.radius=e,this}setFromPoints(t,e){let n=this.center;e!==void 0?n.copy(e):v_.setFromPoints(t).getCenter(n);let s=0;for(let r=0,o=t.length;r<o;r++)s=Math.max(s,n.distanceToSquared(t[r]));return this.radius=Math.sqrt(s),this}copy(t){return this.center.copy(t.center),this.radius=t.radius,this}isEmpty(){return this.radius<0}makeEmpty(){return this.center.set(0,0,0),this.radius=-1,this}containsPoint(t){return t.distanceToSquared(this.center)<=this.radius*this.radius}distanceToPoint(t){return t.distanceTo(this.center)-this.radius}intersectsSphere(t){let e=this.radius+t.radius;return t.center.distanceToSquared(this.center)<=e*e}intersectsBox(t){return t.intersectsSphere(this)}intersectsPlane(t){return Math.abs(t.distanceToPoint(this.center))<=this.radius}clampPoint(t,e){let n=this.center.distanceToSquared(t);return e.copy(t),n>this.radius*this.radius&&(e.sub(this.center).normalize(),e.multiplyScalar(this.radius).add(this.center)),e}getBoundingBox(t){return this.isEmpty()?(t.makeEmpty(),t):(t.set(this.center,this.center),t.expandByScalar(this.radius),t)}applyMatrix4(t){return this.center.applyMatrix4(t),this.radius=this.radius*t.getMaxScaleOnAxis(),this}translate(t){return this.center.add(t),this}expandByPoint(t){if(this.isEmpty())return this.center.copy(t),this.radius=0,this;so.subVectors(t,this.center);let e=so.lengthSq();if(e>this.radius*this.radius){let n=Math.sqrt(e),s=(n-this.radius)*.5;this.center.addScaledVector(so,s/n),this.radius+=s}return this}union(t){return t.isEmpty()?this:this.isEmpty()?(this.copy(t),this):(this.center.equals(t.center)===!0?this.radius=Math.max(this.radius,t.radius):(tu.subVectors(t.center,this.center).setLength(t.radius),this.expandByPoint(so.copy(t.center).add(tu)),this.expandByPoint(so.copy(t.center).sub(tu))),this)}equals(t){return t.center.equals(this.center)&&t.radius===this.radius}clone(){return new this.constructor().copy(this)}toJSON(){return{radius:this.radius,center:this.center.toArray()}}fromJSON(t){return this.radius=t.radius,this.center.fromArray(t.center),this}},b_=0,Zn=new Pt,eu=new Tn,rr=new C,Nn=new Se,ro=new Se,Ye=new C,Me=class i extends si{constructor(){super(),this.isBufferGeometry=!0,Object.defineProperty(this,"id",{value:b_++}),this.uuid=fs(),this.name="",this.type="BufferGeometry",this.index=null,this.indirect=null,this.indirectOffset=0,this.attributes={},this.morphAttributes={},this.morphTargetsRelative=!1,this.groups=[],this.boundingBox=null,this.boundingSphere=null,this.drawRange={start:0,count:1/0},this.userData={},this._transformed=!1}getIndex(){return this.index}setIndex(t){return Array.isArray(t)?this.index=new(X0(t)?xo:yo)(t,1):this.index=t,this}setIndirect(t,e=0){return this.indirect=t,this.indirectOffset=e,this}getIndirect(){return this.indirect}getAttribute(t){return this.attributes[t]}setAttribute(t,e){return this.attributes[t]=e,this}deleteAttribute(t){return delete this.attributes[t],this}hasAttribute(t){return this.attributes[t]!==void 0}addGroup(t,e,n=0){this.groups.push({start:t,count:e,materialIndex:n})}clearGroups(){this.groups=[]}setDrawRange(t,e){this.drawRange.start=t,this.drawRange.count=e}applyMatrix4(t){let e=this.attributes.position;e!==void 0&&(e.applyMatrix4(t),e.needsUpdate=!0);let n=this.attributes.normal;if(n!==void 0){let r=new Ut().getNormalMatrix(t);n.applyNormalMatrix(r),n.needsUpdate=!0}let s=this.attributes.tangent;return s!==void 0&&(s.transformDirection(t),s.needsUpdate=!0),this.boundingBox!==null&&this.computeBoundingBox(),this.boundingSphere!==null&&this.computeBoundingSphere(),this._transformed=!0,this}applyQuaternion(t){return Zn.makeRotationFromQuaternion(t),this.applyMatrix4(Zn),this}rotateX(t){return Zn.makeRotationX(t),this.applyMatrix4(Zn),this}rotateY(t){return Zn.makeRotationY(t),this.applyMatrix4(Zn),this}rotateZ(t){return Zn.makeRotationZ(t),this.applyMatrix4(Zn),this}translate(t,e,n){return Zn.makeTranslation(t,e,n),this.applyMatrix4(Zn),this}scale(t,e,n){return Zn.makeScale(t,e,n),this.applyMatrix4(Zn),this}lookAt(t){return eu.lookAt(t),eu.updateMatrix(),this.applyMatrix4(eu.matrix),this}center(){return this.computeBoundingBox(),this.boundingBox.getCenter(rr).negate(),this.translate(rr.x,rr.y,rr.z),this}setFromPoints(t){let e=this.getAttribute("position");if(e===void 0){let n=[];for(let s=0,r=t.length;s<r;s++){let o=t[s];n.push(o.x,o.y,o.z||0)}this.setAttribute("position",new Ze(n,3))}else{let n=Math.min(t.length,e.count);for(let s=0;s<n;s++){let r=t[s];e.setXYZ(s,r.x,r.y,r.z||0)}t.length>e.count&&It("BufferGeometry: Buffer size too small for points data. Use .dispose() and create a new geometry."),e.needsUpdate=!0}return this}computeBoundingBox(){this.boundingBox===null&&(this.boundingBox=new Se);let t=this.attributes.position,e=this.morphAttributes.position;if(t&&t.isGLBufferAttribute){Nt("BufferGeometry.computeBoundingBox(): GLBufferAttribute requires a manual bounding box.",this),this.boundingBox.set(new C(-1/0,-1/0,-1/0),new C(1/0,1/0,1/0));return}if(t!==void 0){if(this.boundingBox.setFromBufferAttribute(t),e)for(let n=0,s=e.length;n<s;n++){let r=e[n];Nn.setFromBufferAttribute(r),this.morphTargetsRelative?(Ye.addVectors(this.boundingBox.min,Nn.min),this.boundingBox.expandByPoint(Ye),Ye.addVectors(this.boundingBox.max,Nn.max),this.boundingBox.expandByPoint(Ye)):(this.boundingBox.expandByPoint(Nn.min),this.boundingBox.expandByPoint(Nn.max))}}else this.boundingBox.makeEmpty();(isNaN(this.boundingBox.min.x)||isNaN(this.boundingBox.min.y)||isNaN(this.boundingBox.min.z))&&Nt('BufferGeometry.computeBoundingBox(): Computed min/max have NaN values. The "position" attribute is likely to have NaN values.',this)}computeBoundingSphere(){this.boundingSphere===null&&(this.boundingSphere=new os);let t=this.attributes.position,e=this.morphAttributes.position;if(t&&t.isGLBufferAttribute){Nt("BufferGeometry.computeBoundingSphere(): GLBufferAttribute requires a manual bounding sphere.",this),this.boundingSphere.set(new C,1/0);return}if(t){let n=this.boundingSphere.center;if(Nn.setFromBufferAttribute(t),e)for(let r=0,o=e.length;r<o;r++){let a=e[r];ro.setFromBufferAttribute(a),this.morphTargetsRelative?(Ye.addVectors(Nn.min,ro.min),Nn.expandByPoint(Ye),Ye.addVectors(Nn.max,ro.max),Nn.expandByPoint(Ye)):(Nn.expandByPoint(ro.min),Nn.expandByPoint(ro.max))}Nn.getCenter(n);let s=0;for(let r=0,o=t.count;r<o;r++)Ye.fromBufferAttribute(t,r),s=Math.max(s,n.distanceToSquared(Ye));if(e)for(let r=0,o=e.length;r<o;r++){let a=e[r],l=this.morphTargetsRelative;for(let c=0,h=a.count;c<h;c++)Ye.fromBufferAttribute(a,c),l&&(rr.fromBufferAttribute(t,c),Ye.add(rr)),s=Math.max(s,n.distanceToSquared(Ye))}this.boundingSphere.radius=Math.sqrt(s),isNaN(this.boundingSphere.radius)&&Nt('BufferGeometry.computeBoundingSphere(): Computed radius is NaN. The "position" attribute is likely to have NaN values.',this)}}computeTangents(){let t=this.index,e=this.attributes;if(t===null||e.position===void 0||e.normal===void 0||e.uv===void 0){Nt("BufferGeometry: .computeTangents() failed. Missing required attributes (index, position, normal or uv)");return}let n=e.position,s=e.normal,r=e.uv,o=this.getAttribute("tangent");(o===void 0||o.count!==n.count)&&(o=new Ht(new Float32Array(4*n.count),4),this.setAttribute("tangent",o));let a=[],l=[],c=new Uint8Array(n.count);for(let D=0;D<n.count;D++)a[D]=new C,l[D]=new C;let h=new C,u=new C,d=new C,f=new St,p=new St,_=new St,m=new C,g=new C;function y(D,R,N){c[D]=c[R]=c[N]=1,h.fromBufferAttribute(n,D),u.fromBufferAttribute(n,R),d.fromBufferAttribute(n,N),f.fromBufferAttribute(r,D),p.fromBufferAttribute(r,R),_.fromBufferAttribute(r,N),u.sub(h),d.sub(h),p.sub(f),_.sub(f);let P=1/(p.x*_.y-_.x*p.y);isFinite(P)&&(m.copy(u).multiplyScalar(_.y).addScaledVector(d,-p.y).multiplyScalar(P),g.copy(d).multiplyScalar(p.x).addScaledVector(u,-_.x).multiplyScalar(P),a[D].add(m),a[R].add(m),a[N].add(m),l[D].add(g),l[R].add(g),l[N].add(g))}let b=this.groups;b.length===0&&(b=[{start:0,count:t.count}]);for(let D=0,R=b.length;D<R;++D){let N=b[D],P=N.start,U=N.count;for(let L=P,k=P+U;L<k;L+=3)y(t.getX(L+0),t.getX(L+1),t.getX(L+2))}let v=new C,M=new C,A=new C,x=new C;function w(D){A.fromBufferAttribute(s,D),x.copy(A);let R=a[D];v.copy(R),v.sub(A.multiplyScalar(A.dot(R))).normalize(),M.crossVectors(x,R);let P=M.dot(l[D])<0?-1:1;o.setXYZW(D,v.x,v.y,v.z,P)}for(let D=0,R=n.count;D<R;++D)c[D]&&w(D);this._transformed=!0}computeVertexNormals(){let t=this.index,e=this.getAttribute("position");if(e!==void 0){let n=this.getAttribute("normal");if(n===void 0||n.count!==e.count)n=new Ht(new Float32Array(e.count*3),3),this.setAttribute("normal",n);else for(let d=0,f=n.count;d<f;d++)n.setXYZ(d,0,0,0);let s=new C,r=new C,o=new C,a=new C,l=new C,c=new C,h=new C,u=new C;if(t)for(let d=0,f=t.count;d<f;d+=3){let p=t.getX(d+0),_=t.getX(d+1),m=t.getX(d+2);s.fromBufferAttribute(e,p),r.fromBufferAttribute(e,_),o.fromBufferAttribute(e,m),h.subVectors(o,r),u.subVectors(s,r),h.cross(u),a.fromBufferAttribute(n,p),l.fromBufferAttribute(n,_),c.fromBufferAttribute(n,m),a.add(h),l.add(h),c.add(h),n.setXYZ(p,a.x,a.y,a.z),n.setXYZ(_,l.x,l.y,l.z),n.setXYZ(m,c.x,c.y,c.z)}else for(let d=0,f=e.count;d<f;d+=3)s.fromBufferAttribute(e,d+0),r.fromBufferAttribute(e,d+1),o.fromBufferAttribute(e,d+2),h.subVectors(o,r),u.subVectors(s,r),h.cross(u),n.setXYZ(d+0,h.x,h.y,h.z),n.setXYZ(d+1,h.x,h.y,h.z),n.setXYZ(d+2,h.x,h.y,h.z);this.normalizeNormals(),n.needsUpdate=!0}}normalizeNormals(){let t=this.attributes.normal;for(let e=0,n=t.count;e<n;e++)Ye.fromBufferAttribute(t,e),Ye.normalize(),t.setXYZ(e,Ye.x,Ye.y,Ye.z)}toNonIndexed(){function t(a,l){let c=a.array,h=a.itemSize,u=a.normalized,d=new c.constructor(l.length*h),f=0,p=0;for(let _=0,m=l.length;_<m;_++){a.isInterleavedBufferAttribute?f=l[_]*a.data.stride+a.offset:f=l[_]*h;for(let g=0;g<h;g++)d[p++]=c[f++]}return new Ht(d,h,u)}if(this.index===null)return It("BufferGeometry.toNonIndexed(): BufferGeometry is already non-indexed."),this;let e=new i,n=this.index.array,s=this.attributes;for(let a in s){let l=s[a],c=t(l,n);e.setAttribute(a,c)}let r=this.morphAttributes;for(let a in r){let l=[],c=r[a];for(let h=0,u=c.length;h<u;h++){let d=c[h],f=t(d,n);l.push(f)}e.morphAttributes[a]=l}e.morphTargetsRelative=this.morphTargetsRelative;let o=this.groups;for(let a=0,l=o.length;a<l;a++){let c=o[a];e.addGroup(c.start,c.count,c.materialIndex)}return e}toJSON(){let t={metadata:{version:4.7,type:"BufferGeometry",generator:"BufferGeometry.toJSON"}};if(t.uuid=this.uuid,t.type=this.parameters!==void 0&&this._transformed===!0?"BufferGeometry":this.type,t.name=this.name,Object.keys(this.userData).length>0&&(t.userData=this.userData),this.parameters!==void 0&&this._transformed!==!0){let l=this.parameters;for(let c in l)l[c]!==void 0&&(t[c]=l[c]);return t}t.data={attributes:{}};let e=this.index;e!==null&&(t.data.index={type:e.array.constructor.name,array:Array.prototype.slice.call(e.array)});let n=this.attributes;for(let l in n){let c=n[l];t.data.attributes[l]=c.toJSON(t.data)}let s={},r=!1;for(let l in this.morphAttributes){let c=this.morphAttributes[l],h=[];for(let u=0,d=c.length;u<d;u++){let f=c[u];h.push(f.toJSON(t.data))}h.length>0&&(s[l]=h,r=!0)}r&&(t.data.morphAttributes=s,t.data.morphTargetsRelative=this.morphTargetsRelative);let o=this.groups;o.length>0&&(t.data.groups=JSON.parse(JSON.stringify(o)));let a=this.boundingSphere;return a!==null&&(t.data.boundingSphere=a.toJSON()),t}clone(){return new this.constructor().copy(this)}copy(t){this.index=null,this.attributes={},this.morphAttributes={},this.groups=[],this.boundingBox=null,this.boundingSphere=null;let e={};this.name=t.name;let n=t.index;n!==null&&this.setIndex(n.clone());let s=t.attributes;for(let c in s){let h=s[c];this.setAttribute(c,h.clone(e))}let r=t.morphAttributes;for(let c in r){let h=[],u=r[c];for(let d=0,f=u.length;d<f;d++)h.push(u[d].clone(e));this.morphAttributes[c]=h}this.morphTargetsRelative=t.morphTargetsRelative;let o=t.groups;for(let c=0,h=o.length;c<h;c++){let u=o[c];this.addGroup(u.start,u.count,u.materialIndex)}let a=t.boundingBox;a!==null&&(this.boundingBox=a.clone());let l=t.boundingSphere;return l!==null&&(this.boundingSphere=l.clone()),this.drawRange.start=t.drawRange.start,this.drawRange.count=t.drawRange.count,this.userData=t.userData,this._transformed=t._transformed,this}dispose(){this.dispatchEvent({type:"dispose"})}},xl=class{constructor(t,e){this.isInterleavedBuffer=!0,this.array=t,this.stride=e,this.count=t!==void 0?t.length/e:0,this.usage=Vu,this.updateRanges=[],this.version=0,this.uuid=fs()}onUploadCallback(){}set needsUpdate(t){t===!0&&this.version++}setUsage(t){return this.usage=t,this}addUpdateRange(t,e){this.updateRanges.push({start:t,count:e})}clearUpdateRanges(){this.updateRanges.length=0}copy(t){return this.array=new t.array.constructor(t.array),this.count=t.count,this.stride=t.stride,this.usage=t.usage,this}copyAt(t,e,n){t*=this.stride,n*=e.stride;for(let s=0,r=this.stride;s<r;s++)this.array[t+s]=e.array[n+s];return this}set(t,e=0){return this.array.set(t,e),this}clone(t){t.arrayBuffers===void 0&&(t.arrayBuffers={});let e=pp(this.array);t.arrayBuffers[e]===void 0&&(t.arrayBuffers[e]=this.array.slice(0).buffer);let n=new this.array.constructor(t.arrayBuffers[e]),s=new this.constructor(n,this.stride);return s.setUsage(this.usage),s}onUpload(t){return this.onUploadCallback=t,this}toJSON(t){t.arrayBuffers===void 0&&(t.arrayBuffers={});let e=pp(this.array);t.arrayBuffers[e]===void 0&&(t.arrayBuffers[e]=Array.from(new Uint32Array(this.array.slice(0).buffer)));let n={uuid:this.uuid,buffer:e,type:this.array.constructor.name,stride:this.stride};return n.usage=this.usage,n}};function pp(i){return i.buffer._uuid===void 0&&(i.buffer._uuid=fs()),i.byteOffset===0&&i.byteLength===i.buffer.byteLength?i.buffer._uuid:i.buffer._uuid+":"+i.byteOffset+":"+i.byteLength}var gn=new C,xn=class i{constructor(t,e,n,s=!1){this.isInterleavedBufferAttribute=!0,this.name="",this.data=t,this.itemSize=e,this.offset=n,this.normalized=s,this._normalizationScale=t!==void 0?Ac(t.array):void 0}get count(){return this.data.count}get array(){return this.data.array}set needsUpdate(t){this.data.needsUpdate=t}applyMatrix4(t){for(let e=0,n=this.data.count;e<n;e++)gn.fromBufferAttribute(this,e),gn.applyMatrix4(t),this.setXYZ(e,gn.x,gn.y,gn.z);return this}applyNormalMatrix(t){for(let e=0,n=this.count;e<n;e++)gn.fromBufferAttribute(this,e),gn.applyNormalMatrix(t),this.setXYZ(e,gn.x,gn.y,gn.z);return this}transformDirection(t){for(let e=0,n=this.count;e<n;e++)gn.fromBufferAttribute(this,e),gn.transformDirection(t),this.setXYZ(e,gn.x,gn.y,gn.z);return this}getComponent(t,e){let n=this.array[t*this.data.stride+this.offset+e];return this.normalized&&(n=this._denormalize(n)),n}setComponent(t,e,n){return this.normalized&&(n=this._normalize(n)),this.data.array[t*this.data.stride+this.offset+e]=n,this}setX(t,e){return this.normalized&&(e=this._normalize(e)),this.data.array[t*this.data.stride+this.offset]=e,this}setY(t,e){return this.normalized&&(e=this._normalize(e)),this.data.array[t*this.data.stride+this.offset+1]=e,this}setZ(t,e){return this.normalized&&(e=this._normalize(e)),this.data.array[t*this.data.stride+this.offset+2]=e,this}setW(t,e){return this.normalized&&(e=this._normalize(e)),this.data.array[t*this.data.stride+this.offset+3]=e,this}getX(t){let e=this.data.array[t*this.data.stride+this.offset];return this.normalized&&(e=this._denormalize(e)),e}getY(t){let e=this.data.array[t*this.data.stride+this.offset+1];return this.normalized&&(e=this._denormalize(e)),e}getZ(t){let e=this.data.array[t*this.data.stride+this.offset+2];return this.normalized&&(e=this._denormalize(e)),e}getW(t){let e=this.data.array[t*this.data.stride+this.offset+3];return this.normalized&&(e=this._denormalize(e)),e}setXY(t,e,n){return t=t*this.data.stride+this.offset,this.normalized&&(e=this._normalize(e),n=this._normalize(n)),this.data.array[t+0]=e,this.data.array[t+1]=n,this}setXYZ(t,e,n,s){return t=t*this.data.stride+this.offset,this.normalized&&(e=this._normalize(e),n=this._normalize(n),s=this._normalize(s)),this.data.array[t+0]=e,this.data.array[t+1]=n,this.data.array[t+2]=s,this}setXYZW(t,e,n,s,r){return t=t*this.data.stride+this.offset,this.normalized&&(e=this._normalize(e),n=this._normalize(n),s=this._normalize(s),r=this._normalize(r)),this.data.array[t+0]=e,this.data.array[t+1]=n,this.data.array[t+2]=s,this.data.array[t+3]=r,this}clone(t){if(t===void 0){mo("InterleavedBufferAttribute.clone(): Cloning an interleaved buffer attribute will de-interleave buffer data.");let e=[];for(let n=0;n<this.count;n++){let s=n*this.data.stride+this.offset;for(let r=0;r<this.itemSize;r++)e.push(this.data.array[s+r])}return new Ht(new this.array.constructor(e),this.itemSize,this.normalized)}else return t.interleavedBuffers===void 0&&(t.interleavedBuffers={}),t.interleavedBuffers[this.data.uuid]===void 0&&(t.interleavedBuffers[this.data.uuid]=this.data.clone(t)),new i(t.interleavedBuffers[this.data.uuid],this.itemSize,this.offset,this.normalized)}toJSON(t){if(t===void 0){mo("InterleavedBufferAttribute.toJSON(): Serializing an interleaved buffer attribute will de-interleave buffer data.");let e=[];for(let n=0;n<this.count;n++){let s=n*this.data.stride+this.offset;for(let r=0;r<this.itemSize;r++)e.push(this.data.array[s+r])}return{itemSize:this.itemSize,type:this.array.constructor.name,array:e,normalized:this.normalized}}else return t.interleavedBuffers===void 0&&(t.interleavedBuffers={}),t.interleavedBuffers[this.data.uuid]===void 0&&(t.interleavedBuffers[this.data.uuid]=this.data.toJSON(t)),{isInterleavedBufferAttribute:!0,itemSize:this.itemSize,data:this.data.uuid,offset:this.offset,normalized:this.normalized}}_denormalize(t){let e=this._normalizationScale;return e!==void 0?Math.max(t/e,-1):Wu(t,this.data.array)}_normalize(t){let e=this._normalizationScale;return e!==void 0?Math.round(t*e):$u(t,this.data.array)}},nu=new C,S_=new C,M_=new Ut,tn=class{constructor(t=new C(1,0,0),e=0){this.isPlane=!0,this.normal=t,this.constant=e}set(t,e){return this.normal.copy(t),this.constant=e,this}setComponents(t,e,n,s){return this.normal.set(t,e,n),this.constant=s,this}setFromNormalAndCoplanarPoint(t,e){return this.normal.copy(t),this.constant=-e.dot(this.normal),this}setFromCoplanarPoints(t,e,n){let s=nu.subVectors(n,e).cross(S_.subVectors(t,e)).normalize();return this.setFromNormalAndCoplanarPoint(s,t),this}copy(t){return this.normal.copy(t.normal),this.constant=t.constant,this}normalize(){let t=1/this.normal.length();return this.normal.multiplyScalar(t),this.constant*=t,this}negate(){return this.constant*=-1,this.normal.negate(),this}distanceToPoint(t){return this.normal.dot(t)+this.constant}distanceToSphere(t){return this.distanceToPoint(t.center)-t.radius}projectPoint(t,e){return e.copy(t).addScaledVector(this.normal,-this.distanceToPoint(t))}intersectLine(t,e,n=!0){let s=t.delta(nu),r=this.normal.dot(s);if(r===0)return this.distanceToPoint(t.start)===0?e.copy(t.start):null;let o=-(t.start.dot(this.normal)+this.constant)/r;return n===!0&&(o<0||o>1)?null:e.copy(t.start).addScaledVector(s,o)}intersectsLine(t){let e=this.distanceToPoint(t.start),n=this.distanceToPoint(t.end);return e<0&&n>0||n<0&&e>0}intersectsBox(t){return t.intersectsPlane(this)}intersectsSphere(t){return t.intersectsPlane(this)}coplanarPoint(t){return t.copy(this.normal).multiplyScalar(-this.constant)}applyMatrix4(t,e){let n=e||M_.getNormalMatrix(t),s=this.coplanarPoint(nu).applyMatrix4(t),r=this.normal.applyMatrix3(n).normalize();return this.constant=-s.dot(r),this}translate(t){return this.constant-=t.dot(this.normal),this}equals(t){return t.normal.equals(this.normal)&&t.constant===this.constant}clone(){return new this.constructor().copy(this)}toJSON(){return{normal:this.normal.toArray(),constant:this.constant}}fromJSON(t){return this.normal.fromArray(t.normal),this.constant=t.constant,this}},w_=0,Di=class extends si{constructor(){super(),this.isMaterial=!0,Object.defineProperty(this,"id",{value:w_++}),this.uuid=fs(),this.name="",this.type="Material",this.blending=Mr,this.side=oi,this.vertexColors=!1,this.opacity=1,this.transparent=!1,this.alphaHash=!1,this.blendSrc=vu,this.blendDst=bu,this.blendEquation=Ns,this.blendSrcAlpha=null,this.blendDstAlpha=null,this.blendEquationAlpha=null,this.blendColor=new Kt(0,0,0),this.blendAlpha=0,this.depthFunc=fr,this.depthTest=!0,this.depthWrite=!0,this.stencilWriteMask=255,this.stencilFunc=rm,this.stencilRef=0,this.stencilFuncMask=255,this.stencilFail=ol,this.stencilZFail=ol,this.stencilZPass=ol,this.stencilWrite=!1,this.clippingPlanes=null,this.clipIntersection=!1,this.clipShadows=!1,this.shadowSide=null,this.colorWrite=!0,this.precision=null,this.polygonOffset=!1,this.polygonOffsetFactor=0,this.polygonOffsetUnits=0,this.dithering=!1,this.alphaToCoverage=!1,this.premultipliedAlpha=!1,this.forceSinglePass=!1,this.allowOverride=!0,this.visible=!0,this.toneMapped=!0,this.userData={},this.version=0,this._alphaTest=0}get alphaTest(){return this._alphaTest}set alphaTest(t){this._alphaTest>0!=t>0&&this.version++,this._alphaTest=t}onBeforeRender(){}onBeforeCompile(){}customProgramCacheKey(){return this.onBeforeCompile.toString()}setValues(t){if(t!==void 0)for(let e in t){let n=t[e];if(n===void 0){It(`Material: parameter '${e}' has value of undefined.`);continue}let s=this[e];if(s===void 0){It(`Material: '${e}' is not a property of THREE.${this.type}.`);continue}s&&s.isColor?s.set(n):s&&s.isVector2&&n&&n.isVector2||s&&s.isEuler&&n&&n.isEuler||s&&s.isVector3&&n&&n.isVector3?s.copy(n):this[e]=n}}toJSON(t){let e=t===void 0||typeof t=="string";e&&(t={textures:{},images:{}});let n={metadata:{version:4.7,type:"Material",generator:"Material.toJSON"}};n.uuid=this.uuid,n.type=this.type,n.blending=this.blending,n.side=this.side,n.shadowSide=this.shadowSide,n.vertexColors=this.vertexColors,n.opacity=this.opacity,n.transparent=this.transparent,n.blendSrc=this.blendSrc,n.blendDst=this.blendDst,n.blendEquation=this.blendEquation,n.blendSrcAlpha=this.blendSrcAlpha,n.blendDstAlpha=this.blendDstAlpha,n.blendEquationAlpha=this.blendEquationAlpha,n.blendColor=this.blendColor.getHex(),n.blendAlpha=this.blendAlpha,n.depthFunc=this.depthFunc,n.depthTest=this.depthTest,n.depthWrite=this.depthWrite,n.colorWrite=this.colorWrite,n.clipIntersection=this.clipIntersection,n.clipShadows=this.clipShadows,n.stencilWriteMask=this.stencilWriteMask,n.stencilFunc=this.stencilFunc,n.stencilRef=this.stencilRef,n.stencilFuncMask=this.stencilFuncMask,n.stencilFail=this.stencilFail,n.stencilZFail=this.stencilZFail,n.stencilZPass=this.stencilZPass,n.stencilWrite=this.stencilWrite,n.polygonOffset=this.polygonOffset,n.polygonOffsetFactor=this.polygonOffsetFactor,n.polygonOffsetUnits=this.polygonOffsetUnits,n.dithering=this.dithering,n.alphaTest=this.alphaTest,n.alphaHash=this.alphaHash,n.alphaToCoverage=this.alphaToCoverage,n.premultipliedAlpha=this.premultipliedAlpha,n.forceSinglePass=this.forceSinglePass,n.allowOverride=this.allowOverride,n.visible=this.visible,n.toneMapped=this.toneMapped,n.name=this.name,this.color&&this.color.isColor&&(n.color=this.color.getHex()),this.roughness!==void 0&&(n.roughness=this.roughness),this.metalness!==void 0&&(n.metalness=this.metalness),this.sheen!==void 0&&(n.sheen=this.sheen),this.sheenColor&&this.sheenColor.isColor&&(n.sheenColor=this.sheenColor.getHex()),this.sheenRoughness!==void 0&&(n.sheenRoughness=this.sheenRoughness),this.emissive&&this.emissive.isColor&&(n.emissive=this.emissive.getHex()),this.emissiveIntensity!==void 0&&(n.emissiveIntensity=this.emissiveIntensity),this.specular&&this.specular.isColor&&(n.specular=this.specular.getHex()),this.specularIntensity!==void 0&&(n.specularIntensity=this.specularIntensity),this.specularColor&&this.specularColor.isColor&&(n.specularColor=this.specularColor.getHex()),this.shininess!==void 0&&(n.shininess=this.shininess),this.clearcoat!==void 0&&(n.clearcoat=this.clearcoat),this.clearcoatRoughness!==void 0&&(n.clearcoatRoughness=this.clearcoatRoughness),this.diffuseRoughness!==void 0&&(n.diffuseRoughness=this.diffuseRoughness),this.diffuseRoughnessMap&&this.diffuseRoughnessMap.isTexture&&(n.diffuseRoughnessMap=this.diffuseRoughnessMap.toJSON(t).uuid),this.clearcoatMap&&this.clearcoatMap.isTexture&&(n.clearcoatMap=this.clearcoatMap.toJSON(t).uuid),this.clearcoatRoughnessMap&&this.clearcoatRoughnessMap.isTexture&&(n.clearcoatRoughnessMap=this.clearcoatRoughnessMap.toJSON(t).uuid),this.clearcoatNormalMap&&this.clearcoatNormalMap.isTexture&&(n.clearcoatNormalMap=this.clearcoatNormalMap.toJSON(t).uuid,n.clearcoatNormalScale=this.clearcoatNormalScale.toArray()),this.sheenColorMap&&this.sheenColorMap.isTexture&&(n.sheenColorMap=this.sheenColorMap.toJSON(t).uuid),this.sheenRoughnessMap&&this.sheenRoughnessMap.isTexture&&(n.sheenRoughnessMap=this.sheenRoughnessMap.toJSON(t).uuid),this.dispersion!==void 0&&(n.dispersion=this.dispersion),this.retroreflectivity!==void 0&&(n.retroreflectivity=this.retroreflectivity),this.iridescence!==void 0&&(n.iridescence=this.iridescence),this.iridescenceIOR!==void 0&&(n.iridescenceIOR=this.iridescenceIOR),this.iridescenceThicknessMinimum!==void 0&&(n.iridescenceThicknessMinimum=this.iridescenceThicknessMinimum),this.iridescenceThicknessMaximum!==void 0&&(n.iridescenceThicknessMaximum=this.iridescenceThicknessMaximum),this.iridescenceMap&&this.iridescenceMap.isTexture&&(n.iridescenceMap=this.iridescenceMap.toJSON(t).uuid),this.iridescenceThicknessMap&&this.iridescenceThicknessMap.isTexture&&(n.iridescenceThicknessMap=this.iridescenceThicknessMap.toJSON(t).uuid),this.anisotropy!==void 0&&(n.anisotropy=this.anisotropy),this.anisotropyRotation!==void 0&&(n.anisotropyRotation=this.anisotropyRotation),this.anisotropyMap&&this.anisotropyMap.isTexture&&(n.anisotropyMap=this.anisotropyMap.toJSON(t).uuid),this.map&&this.map.isTexture&&(n.map=this.map.toJSON(t).uuid),this.matcap&&this.matcap.isTexture&&(n.matcap=this.matcap.toJSON(t).uuid),this.alphaMap&&this.alphaMap.isTexture&&(n.alphaMap=this.alphaMap.toJSON(t).uuid),this.lightMap&&this.lightMap.isTexture&&(n.lightMap=this.lightMap.toJSON(t).uuid,n.lightMapIntensity=this.lightMapIntensity),this.aoMap&&this.aoMap.isTexture&&(n.aoMap=this.aoMap.toJSON(t).uuid,n.aoMapIntensity=this.aoMapIntensity),this.bumpMap&&this.bumpMap.isTexture&&(n.bumpMap=this.bumpMap.toJSON(t).uuid,n.bumpScale=this.bumpScale),this.normalMap&&this.normalMap.isTexture&&(n.normalMap=this.normalMap.toJSON(t).uuid,n.normalMapType=this.normalMapType,n.normalScale=this.normalScale.toArray()),this.displacementMap&&this.displacementMap.isTexture&&(n.displacementMap=this.displacementMap.toJSON(t).uuid,n.displacementScale=this.displacementScale,n.displacementBias=this.displacementBias),this.roughnessMap&&this.roughnessMap.isTexture&&(n.roughnessMap=this.roughnessMap.toJSON(t).uuid),this.metalnessMap&&this.metalnessMap.isTexture&&(n.metalnessMap=this.metalnessMap.toJSON(t).uuid),this.emissiveMap&&this.emissiveMap.isTexture&&(n.emissiveMap=this.emissiveMap.toJSON(t).uuid),this.specularMap&&this.specularMap.isTexture&&(n.specularMap=this.specularMap.toJSON(t).uuid),this.specularIntensityMap&&this.specularIntensityMap.isTexture&&(n.specularIntensityMap=this.specularIntensityMap.toJSON(t).uuid),this.specularColorMap&&this.specularColorMap.isTexture&&(n.specularColorMap=this.specularColorMap.toJSON(t).uuid),this.envMap&&this.envMap.isTexture&&(n.envMap=this.envMap.toJSON(t).uuid,this.combine!==void 0&&(n.combine=this.combine)),this.envMapRotation!==void 0&&(n.envMapRotation=this.envMapRotation.toArray()),this.envMapIntensity!==void 0&&(n.envMapIntensity=this.envMapIntensity),this.reflectivity!==void 0&&(n.reflectivity=this.reflectivity),this.refractionRatio!==void 0&&(n.refractionRatio=this.refractionRatio),this.gradientMap&&this.gradientMap.isTexture&&(n.gradientMap=this.gradientMap.toJSON(t).uuid),this.transmission!==void 0&&(n.transmission=this.transmission),this.transmissionMap&&this.transmissionMap.isTexture&&(n.transmissionMap=this.transmissionMap.toJSON(t).uuid),this.thickness!==void 0&&(n.thickness=this.thickness),this.thicknessMap&&this.thicknessMap.isTexture&&(n.thicknessMap=this.thicknessMap.toJSON(t).uuid),this.attenuationDistance!==void 0&&(n.attenuationDistance=this.attenuationDistance),this.attenuationColor!==void 0&&(n.attenuationColor=this.attenuationColor.getHex()),this.size!==void 0&&(n.size=this.size),this.sizeAttenuation!==void 0&&(n.sizeAttenuation=this.sizeAttenuation),Array.isArray(this.clippingPlanes)&&this.clippingPlanes.length>0&&(n.clippingPlanes=this.clippingPlanes.map(r=>r.toJSON())),this.rotation!==void 0&&(n.rotation=this.rotation),this.depthPacking!==void 0&&(n.depthPacking=this.depthPacking),this.linewidth!==void 0&&(n.linewidth=this.linewidth),this.linecap!==void 0&&(n.linecap=this.linecap),this.linejoin!==void 0&&(n.linejoin=this.linejoin),this.dashSize!==void 0&&(n.dashSize=this.dashSize),this.gapSize!==void 0&&(n.gapSize=this.gapSize),this.scale!==void 0&&(n.scale=this.scale),this.wireframe!==void 0&&(n.wireframe=this.wireframe),this.wireframeLinewidth!==void 0&&(n.wireframeLinewidth=this.wireframeLinewidth),this.wireframeLinecap!==void 0&&(n.wireframeLinecap=this.wireframeLinecap),this.wireframeLinejoin!==void 0&&(n.wireframeLinejoin=this.wireframeLinejoin),this.flatShading!==void 0&&(n.flatShading=this.flatShading),this.fog!==void 0&&(n.fog=this.fog),Object.keys(this.userData).length>0&&(n.userData=this.userData);function s(r){let o=[];for(let a in r){let l=r[a];delete l.metadata,o.push(l)}return o}if(e){let r=s(t.textures),o=s(t.images);r.length>0&&(n.textures=r),o.length>0&&(n.images=o)}return n}fromJSON(t,e){if(t.uuid!==void 0&&(this.uuid=t.uuid),t.name!==void 0&&(this.name=t.name),t.color!==void 0&&this.color!==void 0&&this.color.setHex(t.color),t.roughness!==void 0&&(this.roughness=t.roughness),t.metalness!==void 0&&(this.metalness=t.metalness),t.sheen!==void 0&&(this.sheen=t.sheen),t.sheenColor!==void 0&&(this.sheenColor=new Kt().setHex(t.sheenColor)),t.sheenRoughness!==void 0&&(this.sheenRoughness=t.sheenRoughness),t.emissive!==void 0&&this.emissive!==void 0&&this.emissive.setHex(t.emissive),t.specular!==void 0&&this.specular!==void 0&&this.specular.setHex(t.specular),t.specularIntensity!==void 0&&(this.specularIntensity=t.specularIntensity),t.specularColor!==void 0&&this.specularColor!==void 0&&this.specularColor.setHex(t.specularColor),t.shininess!==void 0&&(this.shininess=t.shininess),t.clearcoat!==void 0&&(this.clearcoat=t.clearcoat),t.clearcoatRoughness!==void 0&&(this.clearcoatRoughness=t.clearcoatRoughness),t.diffuseRoughness!==void 0&&(this.diffuseRoughness=t.diffuseRoughness),t.dispersion!==void 0&&(this.dispersion=t.dispersion),t.retroreflectivity!==void 0&&(this.retroreflectivity=t.retroreflectivity),t.iridescence!==void 0&&(this.iridescence=t.iridescence),t.iridescenceIOR!==void 0&&(this.iridescenceIOR=t.iridescenceIOR),t.iridescenceThicknessMinimum!==void 0&&(this.iridescenceThicknessMinimum=t.iridescenceThicknessMinimum),t.iridescenceThicknessMaximum!==void 0&&(this.iridescenceThicknessMaximum=t.iridescenceThicknessMaximum),t.iridescenceThicknessRange!==void 0&&(this.iridescenceThicknessMinimum=t.iridescenceThicknessRange[0],this.iridescenceThicknessMaximum=t.iridescenceThicknessRange[1]),t.transmission!==void 0&&(this.transmission=t.transmission),t.thickness!==void 0&&(this.thickness=t.thickness),t.attenuationDistance!==void 0&&(this.attenuationDistance=t.attenuationDistance),t.attenuationColor!==void 0&&this.attenuationColor!==void 0&&this.attenuationColor.setHex(t.attenuationColor),t.anisotropy!==void 0&&(this.anisotropy=t.anisotropy),t.anisotropyRotation!==void 0&&(this.anisotropyRotation=t.anisotropyRotation),t.fog!==void 0&&(this.fog=t.fog),t.flatShading!==void 0&&(this.flatShading=t.flatShading),t.blending!==void 0&&(this.blending=t.blending),t.combine!==void 0&&(this.combine=t.combine),t.side!==void 0&&(this.side=t.side),t.shadowSide!==void 0&&(this.shadowSide=t.shadowSide),t.opacity!==void 0&&(this.opacity=t.opacity),t.transparent!==void 0&&(this.transparent=t.transparent),t.alphaTest!==void 0&&(this.alphaTest=t.alphaTest),t.alphaHash!==void 0&&(this.alphaHash=t.alphaHash),t.depthFunc!==void 0&&(this.depthFunc=t.depthFunc),t.depthTest!==void 0&&(this.depthTest=t.depthTest),t.depthWrite!==void 0&&(this.depthWrite=t.depthWrite),t.colorWrite!==void 0&&(this.colorWrite=t.colorWrite),t.clippingPlanes!==void 0&&(this.clippingPlanes=t.clippingPlanes.map(n=>new tn().fromJSON(n))),t.clipIntersection!==void 0&&(this.clipIntersection=t.clipIntersection),t.clipShadows!==void 0&&(this.clipShadows=t.clipShadows),t.depthPacking!==void 0&&(this.depthPacking=t.depthPacking),t.blendSrc!==void 0&&(this.blendSrc=t.blendSrc),t.blendDst!==void 0&&(this.blendDst=t.blendDst),t.blendEquation!==void 0&&(this.blendEquation=t.blendEquation),t.blendSrcAlpha!==void 0&&(this.blendSrcAlpha=t.blendSrcAlpha),t.blendDstAlpha!==void 0&&(this.blendDstAlpha=t.blendDstAlpha),t.blendEquationAlpha!==void 0&&(this.blendEquationAlpha=t.blendEquationAlpha),t.blendColor!==void 0&&this.blendColor!==void 0&&this.blendColor.setHex(t.blendColor),t.blendAlpha!==void 0&&(this.blendAlpha=t.blendAlpha),t.stencilWriteMask!==void 0&&(this.stencilWriteMask=t.stencilWriteMask),t.stencilFunc!==void 0&&(this.stencilFunc=t.stencilFunc),t.stencilRef!==void 0&&(this.stencilRef=t.stencilRef),t.stencilFuncMask!==void 0&&(this.stencilFuncMask=t.stencilFuncMask),t.stencilFail!==void 0&&(this.stencilFail=t.stencilFail),t.stencilZFail!==void 0&&(this.stencilZFail=t.stencilZFail),t.stencilZPass!==void 0&&(this.stencilZPass=t.stencilZPass),t.stencilWrite!==void 0&&(this.stencilWrite=t.stencilWrite),t.wireframe!==void 0&&(this.wireframe=t.wireframe),t.wireframeLinewidth!==void 0&&(this.wireframeLinewidth=t.wireframeLinewidth),t.wireframeLinecap!==void 0&&(this.wireframeLinecap=t.wireframeLinecap),t.wireframeLinejoin!==void 0&&(this.wireframeLinejoin=t.wireframeLinejoin),t.rotation!==void 0&&(this.rotation=t.rotation),t.linewidth!==void 0&&(this.linewidth=t.linewidth),t.linecap!==void 0&&(this.linecap=t.linecap),t.linejoin!==void 0&&(this.linejoin=t.linejoin),t.dashSize!==void 0&&(this.dashSize=t.dashSize),t.gapSize!==void 0&&(this.gapSize=t.gapSize),t.scale!==void 0&&(this.scale=t.scale),t.polygonOffset!==void 0&&(this.polygonOffset=t.polygonOffset),t.polygonOffsetFactor!==void 0&&(this.polygonOffsetFactor=t.polygonOffsetFactor),t.polygonOffsetUnits!==void 0&&(this.polygonOffsetUnits=t.polygonOffsetUnits),t.dithering!==void 0&&(this.dithering=t.dithering),t.alphaToCoverage!==void 0&&(this.alphaToCoverage=t.alphaToCoverage),t.premultipliedAlpha!==void 0&&(this.premultipliedAlpha=t.premultipliedAlpha),t.forceSinglePass!==void 0&&(this.forceSinglePass=t.forceSinglePass),t.allowOverride!==void 0&&(this.allowOverride=t.allowOverride),t.visible!==void 0&&(this.visible=t.visible),t.toneMapped!==void 0&&(this.toneMapped=t.toneMapped),t.userData!==void 0&&(this.userData=t.userData),t.vertexColors!==void 0&&(typeof t.vertexColors=="number"?this.vertexColors=t.vertexColors>0:this.vertexColors=t.vertexColors),t.size!==void 0&&(this.size=t.size),t.sizeAttenuation!==void 0&&(this.sizeAttenuation=t.sizeAttenuation),t.map!==void 0&&(this.map=e[t.map]||null),t.matcap!==void 0&&(this.matcap=e[t.matcap]||null),t.alphaMap!==void 0&&(this.alphaMap=e[t.alphaMap]||null),t.bumpMap!==void 0&&(this.bumpMap=e[t.bumpMap]||null),t.bumpScale!==void 0&&(this.bumpScale=t.bumpScale),t.normalMap!==void 0&&(this.normalMap=e[t.normalMap]||null),t.normalMapType!==void 0&&(this.normalMapType=t.normalMapType),t.normalScale!==void 0){let n=t.normalScale;Array.isArray(n)===!1&&(n=[n,n]),this.normalScale=new St().fromArray(n)}return t.displacementMap!==void 0&&(this.displacementMap=e[t.displacementMap]||null),t.displacementScale!==void 0&&(this.displacementScale=t.displacementScale),t.displacementBias!==void 0&&(this.displacementBias=t.displacementBias),t.roughnessMap!==void 0&&(this.roughnessMap=e[t.roughnessMap]||null),t.metalnessMap!==void 0&&(this.metalnessMap=e[t.metalnessMap]||null),t.emissiveMap!==void 0&&(this.emissiveMap=e[t.emissiveMap]||null),t.emissiveIntensity!==void 0&&(this.emissiveIntensity=t.emissiveIntensity),t.specularMap!==void 0&&(this.specularMap=e[t.specularMap]||null),t.specularIntensityMap!==void 0&&(this.specularIntensityMap=e[t.specularIntensityMap]||null),t.specularColorMap!==void 0&&(this.specularColorMap=e[t.specularColorMap]||null),t.envMap!==void 0&&(this.envMap=e[t.envMap]||null),t.envMapRotation!==void 0&&this.envMapRotation.fromArray(t.envMapRotation),t.envMapIntensity!==void 0&&(this.envMapIntensity=t.envMapIntensity),t.reflectivity!==void 0&&(this.reflectivity=t.reflectivity),t.refractionRatio!==void 0&&(this.refractionRatio=t.refractionRatio),t.lightMap!==void 0&&(this.lightMap=e[t.lightMap]||null),t.lightMapIntensity!==void 0&&(this.lightMapIntensity=t.lightMapIntensity),t.aoMap!==void 0&&(this.aoMap=e[t.aoMap]||null),t.aoMapIntensity!==void 0&&(this.aoMapIntensity=t.aoMapIntensity),t.gradientMap!==void 0&&(this.gradientMap=e[t.gradientMap]||null),t.clearcoatMap!==void 0&&(this.clearcoatMap=e[t.clearcoatMap]||null),t.clearcoatRoughnessMap!==void 0&&(this.clearcoatRoughnessMap=e[t.clearcoatRoughnessMap]||null),t.clearcoatNormalMap!==void 0&&(this.clearcoatNormalMap=e[t.clearcoatNormalMap]||null),t.clearcoatNormalScale!==void 0&&(this.clearcoatNormalScale=new St().fromArray(t.clearcoatNormalScale)),t.diffuseRoughnessMap!==void 0&&(this.diffuseRoughnessMap=e[t.diffuseRoughnessMap]||null),t.iridescenceMap!==void 0&&(this.iridescenceMap=e[t.iridescenceMap]||null),t.iridescenceThicknessMap!==void 0&&(this.iridescenceThicknessMap=e[t.iridescenceThicknessMap]||null),t.transmissionMap!==void 0&&(this.transmissionMap=e[t.transmissionMap]||null),t.thicknessMap!==void 0&&(this.thicknessMap=e[t.thicknessMap]||null),t.anisotropyMap!==void 0&&(this.anisotropyMap=e[t.anisotropyMap]||null),t.sheenColorMap!==void 0&&(this.sheenColorMap=e[t.sheenColorMap]||null),t.sheenRoughnessMap!==void 0&&(this.sheenRoughnessMap=e[t.sheenRoughnessMap]||null),this}clone(){return new this.constructor().copy(this)}copy(t){this.name=t.name,this.blending=t.blending,this.side=t.side,this.vertexColors=t.vertexColors,this.opacity=t.opacity,this.transparent=t.transparent,this.blendSrc=t.blendSrc,this.blendDst=t.blendDst,this.blendEquation=t.blendEquation,this.blendSrcAlpha=t.blendSrcAlpha,this.blendDstAlpha=t.blendDstAlpha,this.blendEquationAlpha=t.blendEquationAlpha,this.blendColor.copy(t.blendColor),this.blendAlpha=t.blendAlpha,this.depthFunc=t.depthFunc,this.depthTest=t.depthTest,this.depthWrite=t.depthWrite,this.stencilWriteMask=t.stencilWriteMask,this.stencilFunc=t.stencilFunc,this.stencilRef=t.stencilRef,this.stencilFuncMask=t.stencilFuncMask,this.stencilFail=t.stencilFail,this.stencilZFail=t.stencilZFail,this.stencilZPass=t.stencilZPass,this.stencilWrite=t.stencilWrite;let e=t.clippingPlanes,n=null;if(e!==null){let s=e.length;n=new Array(s);for(let r=0;r!==s;++r)n[r]=e[r].clone()}return this.clippingPlanes=n,this.clipIntersection=t.clipIntersection,this.clipShadows=t.clipShadows,this.shadowSide=t.shadowSide,this.colorWrite=t.colorWrite,this.precision=t.precision,this.polygonOffset=t.polygonOffset,this.polygonOffsetFactor=t.polygonOffsetFactor,this.polygonOffsetUnits=t.polygonOffsetUnits,this.dithering=t.dithering,this.alphaTest=t.alphaTest,this.alphaHash=t.alphaHash,this.alphaToCoverage=t.alphaToCoverage,this.premultipliedAlpha=t.premultipliedAlpha,this.forceSinglePass=t.forceSinglePass,this.allowOverride=t.allowOverride,this.visible=t.visible,this.toneMapped=t.toneMapped,this.userData=JSON.parse(JSON.stringify(t.userData)),this}dispose(){this.dispatchEvent({type:"dispose"})}set needsUpdate(t){t===!0&&this.version++}};var Pi=new C,iu=new C,Ba=new C,ka=new C,ri=class{constructor(t=new C,e=new C(0,0,-1)){this.origin=t,this.direction=e}set(t,e){return this.origin.copy(t),this.direction.copy(e),this}copy(t){return this.origin.copy(t.origin),this.direction.copy(t.direction),this}at(t,e){return e.copy(this.origin).addScaledVector(this.direction,t)}lookAt(t){return this.direction.copy(t).sub(this.origin).normalize(),this}recast(t){return this.origin.copy(this.at(t,Pi)),this}closestPointToPoint(t,e){e.subVectors(t,this.origin);let n=e.dot(this.direction);return n<0?e.copy(this.origin):e.copy(this.origin).addScaledVector(this.direction,n)}distanceToPoint(t){return Math.sqrt(this.distanceSqToPoint(t))}distanceSqToPoint(t){let e=Pi.subVectors(t,this.origin).dot(this.direction);return e<0?this.origin.distanceToSquared(t):(Pi.copy(this.origin).addScaledVector(this.direction,e),Pi.distanceToSquared(t))}distanceSqToSegment(t,e,n,s){iu.copy(t).add(e).multiplyScalar(.5),Ba.copy(e).sub(t).normalize(),ka.copy(this.origin).sub(iu);let r=t.distanceTo(e)*.5,o=-this.direction.dot(Ba),a=ka.dot(this.direction),l=-ka.dot(Ba),c=ka.lengthSq(),h=Math.abs(1-o*o),u,d,f,p;if(h>0)if(u=o*l-a,d=o*a-l,p=r*h,u>=0)if(d>=-p)if(d<=p){let _=1/h;u*=_,d*=_,f=u*(u+o*d+2*a)+d*(o*u+d+2*l)+c}else d=r,u=Math.max(0,-(o*d+a)),f=-u*u+d*(d+2*l)+c;else d=-r,u=Math.max(0,-(o*d+a)),f=-u*u+d*(d+2*l)+c;else d<=-p?(u=Math.max(0,-(-o*r+a)),d=u>0?-r:Math.min(Math.max(-r,-l),r),f=-u*u+d*(d+2*l)+c):d<=p?(u=0,d=Math.min(Math.max(-r,-l),r),f=d*(d+2*l)+c):(u=Math.max(0,-(o*r+a)),d=u>0?r:Math.min(Math.max(-r,-l),r),f=-u*u+d*(d+2*l)+c);else d=o>0?-r:r,u=Math.max(0,-(o*d+a)),f=-u*u+d*(d+2*l)+c;return n&&n.copy(this.origin).addScaledVector(this.direction,u),s&&s.copy(iu).addScaledVector(Ba,d),f}intersectSphere(t,e){if(t.radius<0)return null;Pi.subVectors(t.center,this.origin);let n=Pi.dot(this.direction),s=Pi.dot(Pi)-n*n,r=t.radius*t.radius;if(s>r)return null;let o=Math.sqrt(r-s),a=n-o,l=n+o;return l<0?null:a<0?this.at(l,e):this.at(a,e)}intersectsSphere(t){return t.radius<0?!1:this.distanceSqToPoint(t.center)<=t.radius*t.radius}distanceToPlane(t){let e=t.normal.dot(this.direction);if(e===0)return t.distanceToPoint(this.origin)===0?0:null;let n=-(this.origin.dot(t.normal)+t.constant)/e;return n>=0?n:null}intersectPlane(t,e){let n=this.distanceToPlane(t);return n===null?null:this.at(n,e)}intersectsPlane(t){let e=t.distanceToPoint(this.origin);return e===0||t.normal.dot(this.direction)*e<0}intersectBox(t,e){let n,s,r,o,a,l,c=1/this.direction.x,h=1/this.direction.y,u=1/this.direction.z,d=this.origin;return c>=0?(n=(t.min.x-d.x)*c,s=(t.max.x-d.x)*c):(n=(t.max.x-d.x)*c,s=(t.min.x-d.x)*c),h>=0?(r=(t.min.y-d.y)*h,o=(t.max.y-d.y)*h):(r=(t.max.y-d.y)*h,o=(t.min.y-d.y)*h),n>o||r>s||((r>n||isNaN(n))&&(n=r),(o<s||isNaN(s))&&(s=o),u>=0?(a=(t.min.z-d.z)*u,l=(t.max.z-d.z)*u):(a=(t.max.z-d.z)*u,l=(t.min.z-d.z)*u),n>l||a>s)||((a>n||n!==n)&&(n=a),(l<s||s!==s)&&(s=l),s<0)?null:this.at(n>=0?n:s,e)}intersectsBox(t){return this.intersectBox(t,Pi)!==null}intersectTriangle(t,e,n,s,r){let o=this.origin,a=this.direction,l=a.x,c=a.y,h=a.z,u=t.x-o.x,d=t.y-o.y,f=t.z-o.z,p=e.x-o.x,_=e.y-o.y,m=e.z-o.z,g=n.x-o.x,y=n.y-o.y,b=n.z-o.z,v=Math.abs(l),M=Math.abs(c),A=Math.abs(h),x,w,D,R,N,P,U,L,k,z,W,et;if(v>=M&&v>=A?(D=l,P=u,k=p,et=g,l>=0?(x=c,w=h,R=d,N=f,U=_,L=m,z=y,W=b):(x=h,w=c,R=f,N=d,U=m,L=_,z=b,W=y)):M>=A?(D=c,P=d,k=_,et=y,c>=0?(x=h,w=l,R=f,N=u,U=m,L=p,z=b,W=g):(x=l,w=h,R=u,N=f,U=p,L=m,z=g,W=b)):(D=h,P=f,k=m,et=b,h>=0?(x=l,w=c,R=u,N=d,U=p,L=_,z=g,W=y):(x=c,w=l,R=d,N=u,U=_,L=p,z=y,W=g)),D===0)return null;let X=x/D,Q=w/D,tt=1/D,vt=R-X*P,Ft=N-Q*P,J=U-X*k,ut=L-Q*k,xt=z-X*et,Ct=W-Q*et,mt=xt*ut-Ct*J,Bt=vt*Ct-Ft*xt,Ce=J*Ft-ut*vt;if(s){if(mt<0||Bt<0||Ce<0)return null}else if((mt<0||Bt<0||Ce<0)&&(mt>0||Bt>0||Ce>0))return null;let Lt=mt+Bt+Ce;if(Lt===0)return null;let Qt=tt*(mt*P+Bt*k+Ce*et);return(Lt>0?Qt<0:Qt>0)?null:this.at(Qt/Lt,r)}applyMatrix4(t){return this.origin.applyMatrix4(t),this.direction.transformDirection(t),this}equals(t){return t.origin.equals(this.origin)&&t.direction.equals(this.direction)}clone(){return new this.constructor().copy(this)}},Is=class extends Di{constructor(t){super(),this.isMeshBasicMaterial=!0,this.type="MeshBasicMaterial",this.color=new Kt(16777215),this.map=null,this.lightMap=null,this.lightMapIntensity=1,this.aoMap=null,this.aoMapIntensity=1,this.specularMap=null,this.alphaMap=null,this.envMap=null,this.envMapRotation=new rs,this.combine=Su,this.reflectivity=1,this.refractionRatio=.98,this.wireframe=!1,this.wireframeLinewidth=1,this.wireframeLinecap="round",this.wireframeLinejoin="round",this.fog=!0,this.setValues(t)}copy(t){return super.copy(t),this.color.copy(t.color),this.map=t.map,this.lightMap=t.lightMap,this.lightMapIntensity=t.lightMapIntensity,this.aoMap=t.aoMap,this.aoMapIntensity=t.aoMapIntensity,this.specularMap=t.specularMap,this.alphaMap=t.alphaMap,this.envMap=t.envMap,this.envMapRotation.copy(t.envMapRotation),this.combine=t.combine,this.reflectivity=t.reflectivity,this.refractionRatio=t.refractionRatio,this.wireframe=t.wireframe,this.wireframeLinewidth=t.wireframeLinewidth,this.wireframeLinecap=t.wireframeLinecap,this.wireframeLinejoin=t.wireframeLinejoin,this.fog=t.fog,this}},mp=new Pt,Cs=new ri,za=new os,gp=new C,Va=new C,Ga=new C,Ha=new C,su=new C,Wa=new C,_p=new C,$a=new C,Ee=class extends Tn{constructor(t=new Me,e=new Is){super(),this.isMesh=!0,this.type="Mesh",this.geometry=t,this.material=e,this.morphTargetDictionary=void 0,this.morphTargetInfluences=void 0,this.count=1,this.updateMorphTargets()}copy(t,e){return super.copy(t,e),t.morphTargetInfluences!==void 0?this.morphTargetInfluences=t.morphTargetInfluences.slice():this.morphTargetInfluences=void 0,t.morphTargetDictionary!==void 0?this.morphTargetDictionary=Object.assign({},t.morphTargetDictionary):this.morphTargetDictionary=void 0,this.material=Array.isArray(t.material)?t.material.slice():t.material,this.geometry=t.geometry,this}updateMorphTargets(){let e=this.geometry.morphAttributes,n=Object.keys(e);if(n.length>0){let s=e[n[0]];if(s!==void 0){this.morphTargetInfluences=[],this.morphTargetDictionary={};for(let r=0,o=s.length;r<o;r++){let a=s[r].name||String(r);this.morphTargetInfluences.push(0),this.morphTargetDictionary[a]=r}}}}getVertexPosition(t,e){let n=this.geometry,s=n.attributes.position,r=n.morphAttributes.position,o=n.morphTargetsRelative;e.fromBufferAttribute(s,t);let a=this.morphTargetInfluences;if(r&&a){Wa.set(0,0,0);for(let l=0,c=r.length;l<c;l++){let h=a[l],u=r[l];h!==0&&(su.fromBufferAttribute(u,t),o?Wa.addScaledVector(su,h):Wa.addScaledVector(su.sub(e),h))}e.add(Wa)}return e}intersectsFrustum(t){return t.intersectsObject(this)}raycast(t,e){let n=this.geometry,s=this.material,r=this.matrixWorld;s!==void 0&&(n.boundingSphere===null&&n.computeBoundingSphere(),za.copy(n.boundingSphere),za.applyMatrix4(r),Cs.copy(t.ray).recast(t.near),!(za.containsPoint(Cs.origin)===!1&&(Cs.intersectSphere(za,gp)===null||Cs.origin.distanceToSquared(gp)>(t.far-t.near)**2))&&(mp.copy(r).invert(),Cs.copy(t.ray).applyMatrix4(mp),!(n.boundingBox!==null&&Cs.intersectsBox(n.boundingBox)===!1)&&this._computeIntersections(t,e,Cs)))}_computeIntersections(t,e,n){let s,r=this.geometry,o=this.material,a=r.index,l=r.attributes.position,c=r.attributes.uv,h=r.attributes.uv1,u=r.attributes.normal,d=r.groups,f=r.drawRange;if(a!==null)if(Array.isArray(o))for(let p=0,_=d.length;p<_;p++){let m=d[p],g=o[m.materialIndex],y=Math.max(m.start,f.start),b=Math.min(a.count,Math.min(m.start+m.count,f.start+f.count));for(let v=y,M=b;v<M;v+=3){let A=a.getX(v),x=a.getX(v+1),w=a.getX(v+2);s=Xa(this,g,t,n,c,h,u,A,x,w),s&&(s.faceIndex=Math.floor(v/3),s.face.materialIndex=m.materialIndex,e.push(s))}}else{let p=Math.max(0,f.start),_=Math.min(a.count,f.start+f.count);for(let m=p,g=_;m<g;m+=3){let y=a.getX(m),b=a.getX(m+1),v=a.getX(m+2);s=Xa(this,o,t,n,c,h,u,y,b,v),s&&(s.faceIndex=Math.floor(m/3),e.push(s))}}else if(l!==void 0)if(Array.isArray(o))for(let p=0,_=d.length;p<_;p++){let m=d[p],g=o[m.materialIndex],y=Math.max(m.start,f.start),b=Math.min(l.count,Math.min(m.start+m.count,f.start+f.count));for(let v=y,M=b;v<M;v+=3){let A=v,x=v+1,w=v+2;s=Xa(this,g,t,n,c,h,u,A,x,w),s&&(s.faceIndex=Math.floor(v/3),s.face.materialIndex=m.materialIndex,e.push(s))}}else{let p=Math.max(0,f.start),_=Math.min(l.count,f.start+f.count);for(let m=p,g=_;m<g;m+=3){let y=m,b=m+1,v=m+2;s=Xa(this,o,t,n,c,h,u,y,b,v),s&&(s.faceIndex=Math.floor(m/3),e.push(s))}}}};function A_(i,t,e,n,s,r,o,a){let l;if(t.side===nn?l=n.intersectTriangle(o,r,s,!0,a):l=n.intersectTriangle(s,r,o,t.side===oi,a),l===null)return null;$a.copy(a),$a.applyMatrix4(i.matrixWorld);let c=e.ray.origin.distanceTo($a);return c<e.near||c>e.far?null:{distance:c,point:$a.clone(),object:i}}function Xa(i,t,e,n,s,r,o,a,l,c){i.getVertexPosition(a,Va),i.getVertexPosition(l,Ga),i.getVertexPosition(c,Ha);let h=A_(i,t,e,n,Va,Ga,Ha,_p);if(h){let u=new C;en.getBarycoord(_p,Va,Ga,Ha,u),s&&(h.uv=en.getInterpolatedAttribute(s,a,l,c,u,new St)),r&&(h.uv1=en.getInterpolatedAttribute(r,a,l,c,u,new St)),o&&(h.normal=en.getInterpolatedAttribute(o,a,l,c,u,new C),h.normal.dot(n.direction)>0&&h.normal.multiplyScalar(-1));let d={a,b:l,c,normal:new C,materialIndex:0};en.getNormal(Va,Ga,Ha,d.normal),h.face=d,h.barycoord=u}return h}var mi=class extends En{constructor(t=null,e=1,n=1,s,r,o,a,l,c=ye,h=ye,u,d){super(null,o,a,l,c,h,s,r,u,d),this.isDataTexture=!0,this.image={data:t,width:e,height:n},this.generateMipmaps=!1,this.flipY=!1,this.unpackAlignment=1}};var vo=class extends Ht{constructor(t,e,n,s=1){super(t,e,n),this.isInstancedBufferAttribute=!0,this.meshPerAttribute=s}copy(t){return super.copy(t),this.meshPerAttribute=t.meshPerAttribute,this}toJSON(){let t=super.toJSON();return t.meshPerAttribute=this.meshPerAttribute,t.isInstancedBufferAttribute=!0,t}};var Ps=new os,E_=new St(.5,.5),qa=new C,Ls=class{constructor(t=new tn,e=new tn,n=new tn,s=new tn,r=new tn,o=new tn){this.planes=[t,e,n,s,r,o]}set(t,e,n,s,r,o){let a=this.planes;return a[0].copy(t),a[1].copy(e),a[2].copy(n),a[3].copy(s),a[4].copy(r),a[5].copy(o),this}copy(t){let e=this.planes;for(let n=0;n<6;n++)e[n].copy(t.planes[n]);return this}setFromProjectionMatrix(t,e=Jn,n=!1){let s=this.planes,r=t.elements,o=r[0],a=r[1],l=r[2],c=r[3],h=r[4],u=r[5],d=r[6],f=r[7],p=r[8],_=r[9],m=r[10],g=r[11],y=r[12],b=r[13],v=r[14],M=r[15];if(s[0].setComponents(c-o,f-h,g-p,M-y).normalize(),s[1].setComponents(c+o,f+h,g+p,M+y).normalize(),s[2].setComponents(c+a,f+u,g+_,M+b).normalize(),s[3].setComponents(c-a,f-u,g-_,M-b).normalize(),n)s[4].setComponents(l,d,m,v).normalize(),s[5].setComponents(c-l,f-d,g-m,M-v).normalize();else if(s[4].setComponents(c-l,f-d,g-m,M-v).normalize(),e===Jn)s[5].setComponents(c+l,f+d,g+m,M+v).normalize();else if(e===fo)s[5].setComponents(l,d,m,v).normalize();else throw new Error("THREE.Frustum.setFromProjectionMatrix(): Invalid coordinate system: "+e);return this}intersectsObject(t){if(t.boundingSphere!==void 0)t.boundingSphere===null&&t.computeBoundingSphere(),Ps.copy(t.boundingSphere).applyMatrix4(t.matrixWorld);else{let e=t.geometry;e.boundingSphere===null&&e.computeBoundingSphere(),Ps.copy(e.boundingSphere).applyMatrix4(t.matrixWorld)}return this.intersectsSphere(Ps)}intersectsSprite(t){Ps.center.set(0,0,0);let e=E_.distanceTo(t.center);return Ps.radius=.7071067811865476+e,Ps.applyMatrix4(t.matrixWorld),this.intersectsSphere(Ps)}intersectsSphere(t){let e=this.planes,n=t.center,s=-t.radius;for(let r=0;r<6;r++)if(e[r].distanceToPoint(n)<s)return!1;return!0}intersectsBox(t){let e=this.planes;for(let n=0;n<6;n++){let s=e[n];if(qa.x=s.normal.x>0?t.max.x:t.min.x,qa.y=s.normal.y>0?t.max.y:t.min.y,qa.z=s.normal.z>0?t.max.z:t.min.z,s.distanceToPoint(qa)<0)return!1}return!0}containsPoint(t){let e=this.planes;for(let n=0;n<6;n++)if(e[n].distanceToPoint(t)<0)return!1;return!0}clone(){return new this.constructor().copy(this)}},yp=new Pt,vl=class i{constructor(){this.coordinateSystem=Jn,this._frustums=[],this._count=0}setFromArrayCamera(t){let e=t.cameras,n=this._frustums;for(let s=0;s<e.length;s++){let r=e[s];yp.multiplyMatrices(r.projectionMatrix,r.matrixWorldInverse),n[s]===void 0&&(n[s]=new Ls),n[s].setFromProjectionMatrix(yp,r.coordinateSystem,r.reversedDepth)}return this._count=e.length,this}getFrustum(t){return this._frustums[t]}intersectsObject(t){let e=this._frustums;for(let n=0;n<this._count;n++)if(e[n].intersectsObject(t))return!0;return!1}intersectsSprite(t){let e=this._frustums;for(let n=0;n<this._count;n++)if(e[n].intersectsSprite(t))return!0;return!1}intersectsSphere(t){let e=this._frustums;for(let n=0;n<this._count;n++)if(e[n].intersectsSphere(t))return!0;return!1}intersectsBox(t){let e=this._frustums;for(let n=0;n<this._count;n++)if(e[n].intersectsBox(t))return!0;return!1}containsPoint(t){let e=this._frustums;for(let n=0;n<this._count;n++)if(e[n].containsPoint(t))return!0;return!1}copy(t){this.coordinateSystem=t.coordinateSystem;let e=this._frustums,n=t._frustums;for(let s=0;s<t._count;s++)e[s]===void 0&&(e[s]=new Ls),e[s].copy(n[s]);return this._count=t._count,this}clone(){return new i().copy(this)}};var Ni=class extends Di{constructor(t){super(),this.isLineBasicMaterial=!0,this.type="LineBasicMaterial",this.color=new Kt(16777215),this.map=null,this.linewidth=1,this.linecap="round",this.linejoin="round",this.fog=!0,this.setValues(t)}copy(t){return super.copy(t),this.color.copy(t.color),this.map=t.map,this.linewidth=t.linewidth,this.linecap=t.linecap,this.linejoin=t.linejoin,this.fog=t.fog,this}},bl=new C,Sl=new C,xp=new Pt,oo=new ri,Ya=new os,ru=new C,vp=new C,Ml=class extends Tn{constructor(t=new Me,e=new Ni){super(),this.isLine=!0,this.type="Line",this.geometry=t,this.material=e,this.morphTargetDictionary=void 0,this.morphTargetInfluences=void 0,this.updateMorphTargets()}copy(t,e){return super.copy(t,e),t.morphTargetInfluences!==void 0?this.morphTargetInfluences=t.morphTargetInfluences.slice():this.morphTargetInfluences=void 0,t.morphTargetDictionary!==void 0?this.morphTargetDictionary=Object.assign({},t.morphTargetDictionary):this.morphTargetDictionary=void 0,this.material=Array.isArray(t.material)?t.material.slice():t.material,this.geometry=t.geometry,this}computeLineDistances(){let t=this.geometry;if(t.index===null){let e=t.attributes.position,n=[0];for(let s=1,r=e.count;s<r;s++)bl.fromBufferAttribute(e,s-1),Sl.fromBufferAttribute(e,s),n[s]=n[s-1],n[s]+=bl.distanceTo(Sl);t.setAttribute("lineDistance",new Ze(n,1))}else It("Line.computeLineDistances(): Computation only possible with non-indexed BufferGeometry.");return this}intersectsFrustum(t){return t.intersectsObject(this)}raycast(t,e){let n=this.geometry,s=this.matrixWorld,r=t.params.Line.threshold,o=n.drawRange;if(n.boundingSphere===null&&n.computeBoundingSphere(),Ya.copy(n.boundingSphere),Ya.applyMatrix4(s),Ya.radius+=r,t.ray.intersectsSphere(Ya)===!1)return;xp.copy(s).invert(),oo.copy(t.ray).applyMatrix4(xp);let a=r/((this.scale.x+this.scale.y+this.scale.z)/3),l=a*a,c=this.isLineSegments?2:1,h=n.index,d=n.attributes.position;if(h!==null){let f=Math.max(0,o.start),p=Math.min(h.count,o.start+o.count);for(let _=f,m=p-1;_<m;_+=c){let g=h.getX(_),y=h.getX(_+1),b=Za(this,t,oo,l,g,y,_);b&&e.push(b)}if(this.isLineLoop){let _=h.getX(p-1),m=h.getX(f),g=Za(this,t,oo,l,_,m,p-1);g&&e.push(g)}}else{let f=Math.max(0,o.start),p=Math.min(d.count,o.start+o.count);for(let _=f,m=p-1;_<m;_+=c){let g=Za(this,t,oo,l,_,_+1,_);g&&e.push(g)}if(this.isLineLoop){let _=Za(this,t,oo,l,p-1,f,p-1);_&&e.push(_)}}}updateMorphTargets(){let e=this.geometry.morphAttributes,n=Object.keys(e);if(n.length>0){let s=e[n[0]];if(s!==void 0){this.morphTargetInfluences=[],this.morphTargetDictionary={};for(let r=0,o=s.length;r<o;r++){let a=s[r].name||String(r);this.morphTargetInfluences.push(0),this.morphTargetDictionary[a]=r}}}}};function Za(i,t,e,n,s,r,o){let a=i.geometry.attributes.position;if(bl.fromBufferAttribute(a,s),Sl.fromBufferAttribute(a,r),e.distanceSqToSegment(bl,Sl,ru,vp)>n)return;ru.applyMatrix4(i.matrixWorld);let c=t.ray.origin.distanceTo(ru);if(!(c<t.near||c>t.far))return{distance:c,point:vp.clone().applyMatrix4(i.matrixWorld),index:o,face:null,faceIndex:null,barycoord:null,object:i}}var bp=new C,Sp=new C,as=class extends Ml{constructor(t,e){super(t,e),this.isLineSegments=!0,this.type="LineSegments"}computeLineDistances(){let t=this.geometry;if(t.index===null){let e=t.attributes.position,n=[];for(let s=0,r=e.count;s<r;s+=2)bp.fromBufferAttribute(e,s),Sp.fromBufferAttribute(e,s+1),n[s]=s===0?0:n[s-1],n[s+1]=n[s]+bp.distanceTo(Sp);t.setAttribute("lineDistance",new Ze(n,1))}else It("LineSegments.computeLineDistances(): Computation only possible with non-indexed BufferGeometry.");return this}};var wl=class extends Di{constructor(t){super(),this.isPointsMaterial=!0,this.type="PointsMaterial",this.color=new Kt(16777215),this.map=null,this.alphaMap=null,this.size=1,this.sizeAttenuation=!0,this.fog=!0,this.setValues(t)}copy(t){return super.copy(t),this.color.copy(t.color),this.map=t.map,this.alphaMap=t.alphaMap,this.size=t.size,this.sizeAttenuation=t.sizeAttenuation,this.fog=t.fog,this}},Mp=new Pt,du=new ri,Ja=new os,Ka=new C,bo=class extends Tn{constructor(t=new Me,e=new wl){super(),this.isPoints=!0,this.type="Points",this.geometry=t,this.material=e,this.morphTargetDictionary=void 0,this.morphTargetInfluences=void 0,this.updateMorphTargets()}copy(t,e){return super.copy(t,e),t.morphTargetInfluences!==void 0?this.morphTargetInfluences=t.morphTargetInfluences.slice():this.morphTargetInfluences=void 0,t.morphTargetDictionary!==void 0?this.morphTargetDictionary=Object.assign({},t.morphTargetDictionary):this.morphTargetDictionary=void 0,this.material=Array.isArray(t.material)?t.material.slice():t.material,this.geometry=t.geometry,this}intersectsFrustum(t){return t.intersectsObject(this)}raycast(t,e){let n=this.geometry,s=this.matrixWorld,r=t.params.Points.threshold,o=n.drawRange;if(n.boundingSphere===null&&n.computeBoundingSphere(),Ja.copy(n.boundingSphere),Ja.applyMatrix4(s),Ja.radius+=r,t.ray.intersectsSphere(Ja)===!1)return;Mp.copy(s).invert(),du.copy(t.ray).applyMatrix4(Mp);let a=r/((this.scale.x+this.scale.y+this.scale.z)/3),l=a*a,c=n.index,u=n.attributes.position;if(c!==null){let d=Math.max(0,o.start),f=Math.min(c.count,o.start+o.count);for(let p=d,_=f;p<_;p++){let m=c.getX(p);Ka.fromBufferAttribute(u,m),wp(Ka,m,l,s,t,e,this)}}else{let d=Math.max(0,o.start),f=Math.min(u.count,o.start+o.count);for(let p=d,_=f;p<_;p++)Ka.fromBufferAttribute(u,p),wp(Ka,p,l,s,t,e,this)}}updateMorphTargets(){let e=this.geometry.morphAttributes,n=Object.keys(e);if(n.length>0){let s=e[n[0]];if(s!==void 0){this.morphTargetInfluences=[],this.morphTargetDictionary={};for(let r=0,o=s.length;r<o;r++){let a=s[r].name||String(r);this.morphTargetInfluences.push(0),this.morphTargetDictionary[a]=r}}}}};function wp(i,t,e,n,s,r,o){let a=du.distanceSqToPoint(i);if(a<e){let l=new C;du.closestPointToPoint(i,l),l.applyMatrix4(n);let c=s.ray.origin.distanceTo(l);if(c<s.near||c>s.far)return;r.push({distance:c,distanceToRay:Math.sqrt(a),point:l,index:t,face:null,faceIndex:null,barycoord:null,object:o})}}var So=class extends En{constructor(t=[],e=Fs,n,s,r,o,a,l,c,h){super(t,e,n,s,r,o,a,l,c,h),this.isCubeTexture=!0,this.flipY=!1}get images(){return this.image}set images(t){this.image=t}};var Fi=class extends En{constructor(t,e,n=ai,s,r,o,a=ye,l=ye,c,h=Li,u=1){if(h!==Li&&h!==Gi)throw new Error("THREE.DepthTexture: format must be either THREE.DepthFormat or THREE.DepthStencilFormat");let d={width:t,height:e,depth:u};super(d,s,r,o,a,l,h,n,c),this.isDepthTexture=!0,this.flipY=!1,this.generateMipmaps=!1,this.compareFunction=null}copy(t){return super.copy(t),this.source=new gr(Object.assign({},t.image)),this.compareFunction=t.compareFunction,this}toJSON(t){let e=super.toJSON(t);return e.compareFunction=this.compareFunction,e}},Mo=class extends Fi{constructor(t,e=ai,n=Fs,s,r,o=ye,a=ye,l,c=Li){let h={width:t,height:t,depth:1},u=[h,h,h,h,h,h];super(t,t,e,n,s,r,o,a,l,c),this.image=u,this.isCubeDepthTexture=!0,this.isCubeTexture=!0}get images(){return this.image}set images(t){this.image=t}},wo=class extends En{constructor(t=null){super(),this.sourceTexture=t,this.isExternalTexture=!0}copy(t){return super.copy(t),this.sourceTexture=t.sourceTexture,this}},Ui=class i extends Me{constructor(t=1,e=1,n=1,s=1,r=1,o=1){super(),this.type="BoxGeometry",this.parameters={width:t,height:e,depth:n,widthSegments:s,heightSegments:r,depthSegments:o};let a=this;s=Math.floor(s),r=Math.floor(r),o=Math.floor(o);let l=[],c=[],h=[],u=[],d=0,f=0;p("z","y","x",-1,-1,n,e,t,o,r,0),p("z","y","x",1,-1,n,e,-t,o,r,1),p("x","z","y",1,1,t,n,e,s,o,2),p("x","z","y",1,-1,t,n,-e,s,o,3),p("x","y","z",1,-1,t,e,n,s,r,4),p("x","y","z",-1,-1,t,e,-n,s,r,5),this.setIndex(l),this.setAttribute("position",new Ze(c,3)),this.setAttribute("normal",new Ze(h,3)),this.setAttribute("uv",new Ze(u,2));function p(_,m,g,y,b,v,M,A,x,w,D){let R=v/x,N=M/w,P=v/2,U=M/2,L=A/2,k=x+1,z=w+1,W=0,et=0,X=new C;for(let Q=0;Q<z;Q++){let tt=Q*N-U;for(let vt=0;vt<k;vt++){let Ft=vt*R-P;X[_]=Ft*y,X[m]=tt*b,X[g]=L,c.push(X.x,X.y,X.z),X[_]=0,X[m]=0,X[g]=A>0?1:-1,h.push(X.x,X.y,X.z),u.push(vt/x),u.push(1-Q/w),W+=1}}for(let Q=0;Q<w;Q++)for(let tt=0;tt<x;tt++){let vt=d+tt+k*Q,Ft=d+tt+k*(Q+1),J=d+(tt+1)+k*(Q+1),ut=d+(tt+1)+k*Q;l.push(vt,Ft,ut),l.push(Ft,J,ut),et+=6}a.addGroup(f,et,D),f+=et,d+=W}}copy(t){return super.copy(t),this.parameters=Object.assign({},t.parameters),this}static fromJSON(t){return new i(t.width,t.height,t.depth,t.widthSegments,t.heightSegments,t.depthSegments)}};var Oi=class i extends Me{constructor(t=1,e=1,n=1,s=32,r=1,o=!1,a=0,l=Math.PI*2){super(),this.type="CylinderGeometry",this.parameters={radiusTop:t,radiusBottom:e,height:n,radialSegments:s,heightSegments:r,openEnded:o,thetaStart:a,thetaLength:l};let c=this;s=Math.floor(s),r=Math.floor(r);let h=[],u=[],d=[],f=[],p=0,_=[],m=n/2,g=0;y(),o===!1&&(t>0&&b(!0),e>0&&b(!1)),this.setIndex(h),this.setAttribute("position",new Ze(u,3)),this.setAttribute("normal",new Ze(d,3)),this.setAttribute("uv",new Ze(f,2));function y(){let v=new C,M=new C,A=0,x=(e-t)/n;for(let w=0;w<=r;w++){let D=[],R=w/r,N=R*(e-t)+t;for(let P=0;P<=s;P++){let U=P/s,L=U*l+a,k=Math.sin(L),z=Math.cos(L);M.x=N*k,M.y=-R*n+m,M.z=N*z,u.push(M.x,M.y,M.z),v.set(k,x,z).normalize(),d.push(v.x,v.y,v.z),f.push(U,1-R),D.push(p++)}_.push(D)}for(let w=0;w<s;w++)for(let D=0;D<r;D++){let R=_[D][w],N=_[D+1][w],P=_[D+1][w+1],U=_[D][w+1];(t>0||D!==0)&&(h.push(R,N,U),A+=3),(e>0||D!==r-1)&&(h.push(N,P,U),A+=3)}c.addGroup(g,A,0),g+=A}function b(v){let M=p,A=new St,x=new C,w=0,D=v===!0?t:e,R=v===!0?1:-1;for(let P=1;P<=s;P++)u.push(0,m*R,0),d.push(0,R,0),f.push(.5,.5),p++;let N=p;for(let P=0;P<=s;P++){let L=P/s*l+a,k=Math.cos(L),z=Math.sin(L);x.x=D*z,x.y=m*R,x.z=D*k,u.push(x.x,x.y,x.z),d.push(0,R,0),A.x=k*.5+.5,A.y=z*.5*R+.5,f.push(A.x,A.y),p++}for(let P=0;P<s;P++){let U=M+P,L=N+P;v===!0?h.push(L,L+1,U):h.push(L+1,L,U),w+=3}c.addGroup(g,w,v===!0?1:2),g+=w}}copy(t){return super.copy(t),this.parameters=Object.assign({},t.parameters),this}static fromJSON(t){return new i(t.radiusTop,t.radiusBottom,t.height,t.radialSegments,t.heightSegments,t.openEnded,t.thetaStart,t.thetaLength)}},Bi=class i extends Oi{constructor(t=1,e=1,n=32,s=1,r=!1,o=0,a=Math.PI*2){super(0,t,e,n,s,r,o,a),this.type="ConeGeometry",this.parameters={radius:t,height:e,radialSegments:n,heightSegments:s,openEnded:r,thetaStart:o,thetaLength:a}}static fromJSON(t){return new i(t.radius,t.height,t.radialSegments,t.heightSegments,t.openEnded,t.thetaStart,t.thetaLength)}};var ja=new C,Qa=new C,ou=new C,tl=new en,Ao=class extends Me{constructor(t=null,e=1){if(super(),this.type="EdgesGeometry",this.parameters={geometry:t,thresholdAngle:e},t!==null){let s=Math.pow(10,4),r=Math.cos(ur*e),o=t.getIndex(),a=t.getAttribute("position"),l=o?o.count:a.count,c=[0,0,0],h=["a","b","c"],u=new Array(3),d=new Map,f=[];for(let p=0;p<l;p+=3){o?(c[0]=o.getX(p),c[1]=o.getX(p+1),c[2]=o.getX(p+2)):(c[0]=p,c[1]=p+1,c[2]=p+2);let{a:_,b:m,c:g}=tl;if(_.fromBufferAttribute(a,c[0]),m.fromBufferAttribute(a,c[1]),g.fromBufferAttribute(a,c[2]),tl.getNormal(ou),u[0]=`${Math.round(_.x*s)},${Math.round(_.y*s)},${Math.round(_.z*s)}`,u[1]=`${Math.round(m.x*s)},${Math.round(m.y*s)},${Math.round(m.z*s)}`,u[2]=`${Math.round(g.x*s)},${Math.round(g.y*s)},${Math.round(g.z*s)}`,!(u[0]===u[1]||u[1]===u[2]||u[2]===u[0]))for(let y=0;y<3;y++){let b=(y+1)%3,v=u[y],M=u[b],A=tl[h[y]],x=tl[h[b]],w=`${v}_${M}`,D=`${M}_${v}`,R=d.get(D);R?(ou.dot(R.normal)<=r&&(f.push(A.x,A.y,A.z),f.push(x.x,x.y,x.z)),d.set(D,null)):d.has(w)||d.set(w,{index0:c[y],index1:c[b],normal:ou.clone()})}}for(let p of d.values())if(p){let{index0:_,index1:m}=p;ja.fromBufferAttribute(a,_),Qa.fromBufferAttribute(a,m),f.push(ja.x,ja.y,ja.z),f.push(Qa.x,Qa.y,Qa.z)}this.setAttribute("position",new Ze(f,3))}}copy(t){return super.copy(t),this.parameters=Object.assign({},t.parameters),this}};var Eo=class i extends Me{constructor(t=1,e=1,n=1,s=1){super(),this.type="PlaneGeometry",this.parameters={width:t,height:e,widthSegments:n,heightSegments:s};let r=t/2,o=e/2,a=Math.floor(n),l=Math.floor(s),c=a+1,h=l+1,u=t/a,d=e/l,f=[],p=[],_=[],m=[];for(let g=0;g<h;g++){let y=g*d-o;for(let b=0;b<c;b++){let v=b*u-r;p.push(v,-y,0),_.push(0,0,1),m.push(b/a),m.push(1-g/l)}}for(let g=0;g<l;g++)for(let y=0;y<a;y++){let b=y+c*g,v=y+c*(g+1),M=y+1+c*(g+1),A=y+1+c*g;f.push(b,v,A),f.push(v,M,A)}this.setIndex(f),this.setAttribute("position",new Ze(p,3)),this.setAttribute("normal",new Ze(_,3)),this.setAttribute("uv",new Ze(m,2))}copy(t){return super.copy(t),this.parameters=Object.assign({},t.parameters),this}static fromJSON(t){return new i(t.width,t.height,t.widthSegments,t.heightSegments)}};function Os(i){let t={};for(let e in i){t[e]={};for(let n in i[e]){let s=i[e][n];if(Ap(s))s.isRenderTargetTexture?(It("UniformsUtils: Textures of render targets cannot be cloned via cloneUniforms() or mergeUniforms()."),t[e][n]=null):t[e][n]=s.clone();else if(Array.isArray(s))if(Ap(s[0])){let r=[];for(let o=0,a=s.length;o<a;o++)r[o]=s[o].clone();t[e][n]=r}else t[e][n]=s.slice();else t[e][n]=s}}return t}function dn(i){let t={};for(let e=0;e<i.length;e++){let n=Os(i[e]);for(let s in n)t[s]=n[s]}return t}function Ap(i){return i&&(i.isColor||i.isMatrix3||i.isMatrix4||i.isVector2||i.isVector3||i.isVector4||i.isTexture||i.isQuaternion)}function T_(i){let t=[];for(let e=0;e<i.length;e++)t.push(i[e].clone());return t}function qu(i){let t=i.getRenderTarget();return t===null?i.outputColorSpace:t.isXRRenderTarget===!0?t.texture.colorSpace:Jt.workingColorSpace}var gm={clone:Os,merge:dn},R_=`void main() {
	gl_Position = projectionMatrix * modelViewMatrix * vec4( position, 1.0 );
}`,C_=`void main() {
	gl_FragColor = vec4( 1.0, 0.0, 0.0, 1.0 );
}`,Ie=class extends Di{constructor(t){super(),this.isShaderMaterial=!0,this.type="ShaderMaterial",this.defines={},this.uniforms={},this.uniformsGroups=[],this.vertexShader=R_,this.fragmentShader=C_,this.linewidth=1,this.wireframe=!1,this.wireframeLinewidth=1,this.fog=!1,this.lights=!1,this.clipping=!1,this.forceSinglePass=!0,this.extensions={clipCullDistance:!1,multiDraw:!1},this.defaultAttributeValues={color:[1,1,1],uv:[0,0],uv1:[0,0]},this.index0AttributeName=void 0,this.uniformsNeedUpdate=!1,this.glslVersion=null,t!==void 0&&this.setValues(t)}copy(t){return super.copy(t),this.fragmentShader=t.fragmentShader,this.vertexShader=t.vertexShader,this.uniforms=Os(t.uniforms),this.uniformsGroups=T_(t.uniformsGroups),this.defines=Object.assign({},t.defines),this.wireframe=t.wireframe,this.wireframeLinewidth=t.wireframeLinewidth,this.fog=t.fog,this.lights=t.lights,this.clipping=t.clipping,this.extensions=Object.assign({},t.extensions),this.glslVersion=t.glslVersion,this.defaultAttributeValues=Object.assign({},t.defaultAttributeValues),this.index0AttributeName=t.index0AttributeName,this.uniformsNeedUpdate=t.uniformsNeedUpdate,this}toJSON(t){let e=super.toJSON(t);e.glslVersion=this.glslVersion,e.uniforms={};for(let s in this.uniforms){let o=this.uniforms[s].value;o&&o.isTexture?e.uniforms[s]={type:"t",value:o.toJSON(t).uuid}:o&&o.isColor?e.uniforms[s]={type:"c",value:o.getHex()}:o&&o.isVector2?e.uniforms[s]={type:"v2",value:o.toArray()}:o&&o.isVector3?e.uniforms[s]={type:"v3",value:o.toArray()}:o&&o.isVector4?e.uniforms[s]={type:"v4",value:o.toArray()}:o&&o.isMatrix3?e.uniforms[s]={type:"m3",value:o.toArray()}:o&&o.isMatrix4?e.uniforms[s]={type:"m4",value:o.toArray()}:e.uniforms[s]={value:o}}Object.keys(this.defines).length>0&&(e.defines=this.defines),e.vertexShader=this.vertexShader,e.fragmentShader=this.fragmentShader,e.lights=this.lights,e.clipping=this.clipping;let n={};for(let s in this.extensions)this.extensions[s]===!0&&(n[s]=!0);return Object.keys(n).length>0&&(e.extensions=n),e}fromJSON(t,e){if(super.fromJSON(t,e),t.uniforms!==void 0)for(let n in t.uniforms){let s=t.uniforms[n];switch(this.uniforms[n]={},s.type){case"t":this.uniforms[n].value=e[s.value]||null;break;case"c":this.uniforms[n].value=new Kt().setHex(s.value);break;case"v2":this.uniforms[n].value=new St().fromArray(s.value);break;case"v3":this.uniforms[n].value=new C().fromArray(s.value);break;case"v4":this.uniforms[n].value=new de().fromArray(s.value);break;case"m3":this.uniforms[n].value=new Ut().fromArray(s.value);break;case"m4":this.uniforms[n].value=new Pt().fromArray(s.value);break;default:this.uniforms[n].value=s.value}}if(t.defines!==void 0&&(this.defines=t.defines),t.vertexShader!==void 0&&(this.vertexShader=t.vertexShader),t.fragmentShader!==void 0&&(this.fragmentShader=t.fragmentShader),t.glslVersion!==void 0&&(this.glslVersion=t.glslVersion),t.extensions!==void 0)for(let n in t.extensions)this.extensions[n]=t.extensions[n];return t.lights!==void 0&&(this.lights=t.lights),t.clipping!==void 0&&(this.clipping=t.clipping),this}},Al=class extends Ie{constructor(t){super(t),this.isRawShaderMaterial=!0,this.type="RawShaderMaterial"}};var El=class extends Di{constructor(t){super(),this.isMeshDepthMaterial=!0,this.type="MeshDepthMaterial",this.depthPacking=im,this.map=null,this.alphaMap=null,this.displacementMap=null,this.displacementScale=1,this.displacementBias=0,this.wireframe=!1,this.wireframeLinewidth=1,this.setValues(t)}copy(t){return super.copy(t),this.depthPacking=t.depthPacking,this.map=t.map,this.alphaMap=t.alphaMap,this.displacementMap=t.displacementMap,this.displacementScale=t.displacementScale,this.displacementBias=t.displacementBias,this.wireframe=t.wireframe,this.wireframeLinewidth=t.wireframeLinewidth,this}},Tl=class extends Di{constructor(t){super(),this.isMeshDistanceMaterial=!0,this.type="MeshDistanceMaterial",this.map=null,this.alphaMap=null,this.displacementMap=null,this.displacementScale=1,this.displacementBias=0,this.setValues(t)}copy(t){return super.copy(t),this.map=t.map,this.alphaMap=t.alphaMap,this.displacementMap=t.displacementMap,this.displacementScale=t.displacementScale,this.displacementBias=t.displacementBias,this}};function or(i,t){return!i||i.constructor===t?i:typeof t.BYTES_PER_ELEMENT=="number"?new t(i):Array.prototype.slice.call(i)}function el(i){return i!==void 0&&i.inTangents!==void 0&&i.outTangents!==void 0}var ls=class{constructor(t,e,n,s){this.parameterPositions=t,this._cachedIndex=0,this.resultBuffer=s!==void 0?s:new e.constructor(n),this.sampleValues=e,this.valueSize=n,this.settings=null,this.DefaultSettings_={}}evaluate(t){let e=this.parameterPositions,n=this._cachedIndex,s=e[n],r=e[n-1];n:{t:{let o;e:{i:if(!(t<s)){for(let a=n+2;;){if(s===void 0){if(t<r)break i;return n=e.length,this._cachedIndex=n,this.copySampleValue_(n-1)}if(n===a)break;if(r=s,s=e[++n],t<s)break t}o=e.length;break e}if(!(t>=r)){let a=e[1];t<a&&(n=2,r=a);for(let l=n-2;;){if(r===void 0)return this._cachedIndex=0,this.copySampleValue_(0);if(n===l)break;if(s=r,r=e[--n-1],t>=r)break t}o=n,n=0;break e}break n}for(;n<o;){let a=n+o>>>1;t<e[a]?o=a:n=a+1}if(s=e[n],r=e[n-1],r===void 0)return this._cachedIndex=0,this.copySampleValue_(0);if(s===void 0)return n=e.length,this._cachedIndex=n,this.copySampleValue_(n-1)}this._cachedIndex=n,this.intervalChanged_(n,r,s)}return this.interpolate_(n,r,t,s)}getSettings_(){return this.settings||this.DefaultSettings_}copySampleValue_(t){let e=this.resultBuffer,n=this.sampleValues,s=this.valueSize,r=t*s;for(let o=0;o!==s;++o)e[o]=n[r+o];return e}interpolate_(){throw new Error("THREE.Interpolant: Call to abstract method.")}intervalChanged_(){}},Rl=class extends ls{constructor(t,e,n,s){super(t,e,n,s),this._weightPrev=-0,this._offsetPrev=-0,this._weightNext=-0,this._offsetNext=-0,this.DefaultSettings_={endingStart:cu,endingEnd:cu}}intervalChanged_(t,e,n){let s=this.parameterPositions,r=t-2,o=t+1,a=s[r],l=s[o];if(a===void 0)switch(this.getSettings_().endingStart){case hu:r=t,a=2*e-n;break;case uu:r=s.length-2,a=e+s[r]-s[r+1];break;default:r=t,a=n}if(l===void 0)switch(this.getSettings_().endingEnd){case hu:o=t,l=2*n-e;break;case uu:o=1,l=n+s[1]-s[0];break;default:o=t-1,l=e}let c=(n-e)*.5,h=this.valueSize;this._weightPrev=c/(e-a),this._weightNext=c/(l-n),this._offsetPrev=r*h,this._offsetNext=o*h}interpolate_(t,e,n,s){let r=this.resultBuffer,o=this.sampleValues,a=this.valueSize,l=t*a,c=l-a,h=this._offsetPrev,u=this._offsetNext,d=this._weightPrev,f=this._weightNext,p=(n-e)/(s-e),_=p*p,m=_*p,g=-d*m+2*d*_-d*p,y=(1+d)*m+(-1.5-2*d)*_+(-.5+d)*p+1,b=(-1-f)*m+(1.5+f)*_+.5*p,v=f*m-f*_;for(let M=0;M!==a;++M)r[M]=g*o[h+M]+y*o[c+M]+b*o[l+M]+v*o[u+M];return r}},Cl=class extends ls{constructor(t,e,n,s){super(t,e,n,s)}interpolate_(t,e,n,s){let r=this.resultBuffer,o=this.sampleValues,a=this.valueSize,l=t*a,c=l-a,h=(n-e)/(s-e),u=1-h;for(let d=0;d!==a;++d)r[d]=o[c+d]*u+o[l+d]*h;return r}},Pl=class extends ls{constructor(t,e,n,s){super(t,e,n,s)}interpolate_(t){return this.copySampleValue_(t-1)}},Il=class extends ls{interpolate_(t,e,n,s){let r=this.resultBuffer,o=this.sampleValues,a=this.valueSize,l=t*a,c=l-a,h=this.inTangents,u=this.outTangents;if(!h||!u){let p=(n-e)/(s-e),_=1-p;for(let m=0;m!==a;++m)r[m]=o[c+m]*_+o[l+m]*p;return r}let d=a*2,f=t-1;for(let p=0;p!==a;++p){let _=o[c+p],m=o[l+p],g=f*d+p*2,y=u[g],b=u[g+1],v=t*d+p*2,M=h[v],A=h[v+1],x=I_(n,e,y,M,s);r[p]=_m(x,_,b,A,m)}return r}};function _m(i,t,e,n,s){let r=1-i;return r*r*r*t+3*r*r*i*e+3*r*i*i*n+i*i*i*s}function P_(i,t,e,n,s){let r=1-i;return 3*r*r*(e-t)+6*r*i*(n-e)+3*i*i*(s-n)}function I_(i,t,e,n,s){let r=(i-t)/(s-t);for(let o=0;o<8;o++){let a=_m(r,t,e,n,s)-i;if(Math.abs(a)<1e-10)break;let l=P_(r,t,e,n,s);if(Math.abs(l)<1e-10)break;r=Math.max(0,Math.min(1,r-a/l))}return r}var On=class{constructor(t,e,n,s){if(t===void 0)throw new Error("THREE.KeyframeTrack: track name is undefined");if(e===void 0||e.length===0)throw new Error("THREE.KeyframeTrack: no keyframes in track named "+t);this.name=t,this.times=or(e,this.TimeBufferType),this.values=or(n,this.ValueBufferType),this.setInterpolation(s||this.DefaultInterpolation)}static toJSON(t){let e=t.constructor,n;if(e.toJSON!==this.toJSON)n=e.toJSON(t);else{n={name:t.name,times:or(t.times,Array),values:or(t.values,Array)};let s=t.getInterpolation();s!==t.DefaultInterpolation&&(n.interpolation=s),el(t.settings)&&(n.settings={inTangents:or(t.settings.inTangents,Array),outTangents:or(t.settings.outTangents,Array)})}return n.type=t.ValueTypeName,n}InterpolantFactoryMethodDiscrete(t){return new Pl(this.times,this.values,this.getValueSize(),t)}InterpolantFactoryMethodLinear(t){return new Cl(this.times,this.values,this.getValueSize(),t)}InterpolantFactoryMethodSmooth(t){return new Rl(this.times,this.values,this.getValueSize(),t)}InterpolantFactoryMethodBezier(t){let e=new Il(this.times,this.values,this.getValueSize(),t);return this.settings&&(e.inTangents=this.settings.inTangents,e.outTangents=this.settings.outTangents),e}setInterpolation(t){let e;switch(t){case co:e=this.InterpolantFactoryMethodDiscrete;break;case gl:e=this.InterpolantFactoryMethodLinear;break;case rl:e=this.InterpolantFactoryMethodSmooth;break;case lu:e=this.InterpolantFactoryMethodBezier;break}if(e===void 0){let n="unsupported interpolation for "+this.ValueTypeName+" keyframe track named "+this.name;if(this.createInterpolant===void 0)if(t!==this.DefaultInterpolation)this.setInterpolation(this.DefaultInterpolation);else throw new Error(n);return It("KeyframeTrack:",n),this}return this.createInterpolant=e,this}getInterpolation(){switch(this.createInterpolant){case this.InterpolantFactoryMethodDiscrete:return co;case this.InterpolantFactoryMethodLinear:return gl;case this.InterpolantFactoryMethodSmooth:return rl;case this.InterpolantFactoryMethodBezier:return lu}}getValueSize(){return this.values.length/this.times.length}shift(t){if(t!==0){let e=this.times;for(let n=0,s=e.length;n!==s;++n)e[n]+=t;el(this.settings)&&(Ep(this.settings.inTangents,t),Ep(this.settings.outTangents,t))}return this}scale(t){if(t!==1){let e=this.times;for(let n=0,s=e.length;n!==s;++n)e[n]*=t;el(this.settings)&&(Tp(this.settings.inTangents,t),Tp(this.settings.outTangents,t))}return this}trim(t,e){let n=this.times,s=n.length,r=0,o=s-1;for(;r!==s&&n[r]<t;)++r;for(;o!==-1&&n[o]>e;)--o;if(++o,r!==0||o!==s){r>=o&&(o=Math.max(o,1),r=o-1);let a=this.getValueSize();this.times=n.slice(r,o),this.values=this.values.slice(r*a,o*a)}return this}validate(){let t=!0,e=this.getValueSize();e-Math.floor(e)!==0&&(Nt("KeyframeTrack: Invalid value size in track.",this),t=!1);let n=this.times,s=this.values,r=n.length;r===0&&(Nt("KeyframeTrack: Track is empty.",this),t=!1);let o=null;for(let a=0;a!==r;a++){let l=n[a];if(typeof l=="number"&&isNaN(l)){Nt("KeyframeTrack: Time is not a valid number.",this,a,l),t=!1;break}if(o!==null&&o>l){Nt("KeyframeTrack: Out of order keys.",this,a,l,o),t=!1;break}o=l}if(s!==void 0&&q0(s))for(let a=0,l=s.length;a!==l;++a){let c=s[a];if(isNaN(c)){Nt("KeyframeTrack: Value is not a valid number.",this,a,c),t=!1;break}}return t}optimize(){let t=this.times.slice(),e=this.values.slice(),n=this.getValueSize(),s=this.getInterpolation()===rl,r=t.length-1,o=1;for(let a=1;a<r;++a){let l=!1,c=t[a],h=t[a+1];if(c!==h&&(a!==1||c!==t[0]))if(s)l=!0;else{let u=a*n,d=u-n,f=u+n;for(let p=0;p!==n;++p){let _=e[u+p];if(_!==e[d+p]||_!==e[f+p]){l=!0;break}}}if(l){if(a!==o){t[o]=t[a];let u=a*n,d=o*n;for(let f=0;f!==n;++f)e[d+f]=e[u+f]}++o}}if(r>0){t[o]=t[r];for(let a=r*n,l=o*n,c=0;c!==n;++c)e[l+c]=e[a+c];++o}return o!==t.length?(this.times=t.slice(0,o),this.values=e.slice(0,o*n)):(this.times=t,this.values=e),this}clone(){let t=this.times.slice(),e=this.values.slice(),n=this.constructor,s=new n(this.name,t,e);return s.createInterpolant=this.createInterpolant,el(this.settings)&&(s.settings={inTangents:this.settings.inTangents.slice(),outTangents:this.settings.outTangents.slice()}),s}};function Ep(i,t){for(let e=0,n=i.length;e!==n;e+=2)i[e]+=t}function Tp(i,t){for(let e=0,n=i.length;e!==n;e+=2)i[e]*=t}On.prototype.ValueTypeName="";On.prototype.TimeBufferType=Float32Array;On.prototype.ValueBufferType=Float32Array;On.prototype.DefaultInterpolation=gl;var cs=class extends On{constructor(t,e,n){super(t,e,n)}};cs.prototype.ValueTypeName="bool";cs.prototype.ValueBufferType=Array;cs.prototype.DefaultInterpolation=co;cs.prototype.InterpolantFactoryMethodLinear=void 0;cs.prototype.InterpolantFactoryMethodSmooth=void 0;var Ll=class extends On{constructor(t,e,n,s){super(t,e,n,s)}};Ll.prototype.ValueTypeName="color";var Dl=class extends On{constructor(t,e,n,s){super(t,e,n,s)}};Dl.prototype.ValueTypeName="number";var Nl=class extends ls{constructor(t,e,n,s){super(t,e,n,s)}interpolate_(t,e,n,s){let r=this.resultBuffer,o=this.sampleValues,a=this.valueSize,l=(n-e)/(s-e),c=t*a;for(let h=c+a;c!==h;c+=4)Oe.slerpFlat(r,0,o,c-a,o,c,l);return r}},To=class extends On{constructor(t,e,n,s){super(t,e,n,s)}InterpolantFactoryMethodLinear(t){return new Nl(this.times,this.values,this.getValueSize(),t)}};To.prototype.ValueTypeName="quaternion";To.prototype.InterpolantFactoryMethodSmooth=void 0;var hs=class extends On{constructor(t,e,n){super(t,e,n)}};hs.prototype.ValueTypeName="string";hs.prototype.ValueBufferType=Array;hs.prototype.DefaultInterpolation=co;hs.prototype.InterpolantFactoryMethodLinear=void 0;hs.prototype.InterpolantFactoryMethodSmooth=void 0;var Fl=class extends On{constructor(t,e,n,s){super(t,e,n,s)}};Fl.prototype.ValueTypeName="vector";var Ul=class{constructor(t,e,n){let s=this,r=!1,o=0,a=0,l,c=[];this.onStart=void 0,this.onLoad=t,this.onProgress=e,this.onError=n,this._abortController=null,this.itemStart=function(h){a++,r===!1&&s.onStart!==void 0&&s.onStart(h,o,a),r=!0},this.itemEnd=function(h){o++,s.onProgress!==void 0&&s.onProgress(h,o,a),o===a&&(r=!1,s.onLoad!==void 0&&s.onLoad())},this.itemError=function(h){s.onError!==void 0&&s.onError(h)},this.resolveURL=function(h){return h=h.normalize("NFC"),l?l(h):h},this.setURLModifier=function(h){return l=h,this},this.addHandler=function(h,u){return c.push(h,u),this},this.removeHandler=function(h){let u=c.indexOf(h);return u!==-1&&c.splice(u,2),this},this.getHandler=function(h){for(let u=0,d=c.length;u<d;u+=2){let f=c[u],p=c[u+1];if(f.global&&(f.lastIndex=0),f.test(h))return p}return null},this.abort=function(){return this.abortController.abort(),this._abortController=null,this}}get abortController(){return this._abortController||(this._abortController=new AbortController),this._abortController}},ym=new Ul,Ol=class{constructor(t){this.manager=t!==void 0?t:ym,this.crossOrigin="anonymous",this.withCredentials=!1,this.path="",this.resourcePath="",this.requestHeader={},this.priority="auto",this.cache="default",typeof __THREE_DEVTOOLS__<"u"&&__THREE_DEVTOOLS__.dispatchEvent(new CustomEvent("observe",{detail:this}))}load(){}loadAsync(t,e){let n=this;return new Promise(function(s,r){n.load(t,s,e,r)})}parse(){}setCrossOrigin(t){return this.crossOrigin=t,this}setWithCredentials(t){return this.withCredentials=t,this}setPath(t){return this.path=t,this}setResourcePath(t){return this.resourcePath=t,this}setRequestHeader(t){return this.requestHeader=t,this}setPriority(t){return this.priority=t,this}setCache(t){return this.cache=t,this}abort(){return this}};Ol.DEFAULT_MATERIAL_NAME="__DEFAULT";var nl=new C,il=new Oe,fi=new C,Ro=class extends Tn{constructor(){super(),this.isCamera=!0,this.type="Camera",this.matrixWorldInverse=new Pt,this.projectionMatrix=new Pt,this.projectionMatrixInverse=new Pt,this.coordinateSystem=Jn,this._reversedDepth=!1}get reversedDepth(){return this._reversedDepth}copy(t,e){return super.copy(t,e),this.matrixWorldInverse.copy(t.matrixWorldInverse),this.projectionMatrix.copy(t.projectionMatrix),this.projectionMatrixInverse.copy(t.projectionMatrixInverse),this.coordinateSystem=t.coordinateSystem,this}getWorldDirection(t){return super.getWorldDirection(t).negate()}updateMatrixWorld(t){super.updateMatrixWorld(t),this.matrixWorld.decompose(nl,il,fi),fi.x===1&&fi.y===1&&fi.z===1?this.matrixWorldInverse.copy(this.matrixWorld).invert():this.matrixWorldInverse.compose(nl,il,fi.set(1,1,1)).invert()}updateWorldMatrix(t,e,n=!1){super.updateWorldMatrix(t,e,n),this.matrixWorld.decompose(nl,il,fi),fi.x===1&&fi.y===1&&fi.z===1?this.matrixWorldInverse.copy(this.matrixWorld).invert():this.matrixWorldInverse.compose(nl,il,fi.set(1,1,1)).invert()}clone(){return new this.constructor().copy(this)}},ss=new C,Rp=new St,Cp=new St,_n=class extends Ro{constructor(t=50,e=1,n=.1,s=2e3){super(),this.isPerspectiveCamera=!0,this.type="PerspectiveCamera",this.fov=t,this.zoom=1,this.near=n,this.far=s,this.focus=10,this.aspect=e,this.view=null,this.filmGauge=35,this.filmOffset=0,this.updateProjectionMatrix()}copy(t,e){return super.copy(t,e),this.fov=t.fov,this.zoom=t.zoom,this.near=t.near,this.far=t.far,this.focus=t.focus,this.aspect=t.aspect,this.view=t.view===null?null:Object.assign({},t.view),this.filmGauge=t.filmGauge,this.filmOffset=t.filmOffset,this}setFocalLength(t){let e=.5*this.getFilmHeight()/t;this.fov=mr*2*Math.atan(e),this.updateProjectionMatrix()}getFocalLength(){let t=Math.tan(ur*.5*this.fov);return .5*this.getFilmHeight()/t}getEffectiveFOV(){return mr*2*Math.atan(Math.tan(ur*.5*this.fov)/this.zoom)}getFilmWidth(){return this.filmGauge*Math.min(this.aspect,1)}getFilmHeight(){return this.filmGauge/Math.max(this.aspect,1)}getViewBounds(t,e,n){ss.set(-1,-1,.5).applyMatrix4(this.projectionMatrixInverse),e.set(ss.x,ss.y).multiplyScalar(-t/ss.z),ss.set(1,1,.5).applyMatrix4(this.projectionMatrixInverse),n.set(ss.x,ss.y).multiplyScalar(-t/ss.z)}getViewSize(t,e){return this.getViewBounds(t,Rp,Cp),e.subVectors(Cp,Rp)}setViewOffset(t,e,n,s,r,o){this.aspect=t/e,this.view===null&&(this.view={enabled:!0,fullWidth:1,fullHeight:1,offsetX:0,offsetY:0,width:1,height:1}),this.view.enabled=!0,this.view.fullWidth=t,this.view.fullHeight=e,this.view.offsetX=n,this.view.offsetY=s,this.view.width=r,this.view.height=o,this.updateProjectionMatrix()}clearViewOffset(){this.view!==null&&(this.view.enabled=!1),this.updateProjectionMatrix()}updateProjectionMatrix(){let t=this.near,e=t*Math.tan(ur*.5*this.fov)/this.zoom,n=2*e,s=this.aspect*n,r=-.5*s,o=this.view;if(this.view!==null&&this.view.enabled){let l=o.fullWidth,c=o.fullHeight;r+=o.offsetX*s/l,e-=o.offsetY*n/c,s*=o.width/l,n*=o.height/c}let a=this.filmOffset;a!==0&&(r+=t*a/this.getFilmWidth()),this.projectionMatrix.makePerspective(r,r+s,e,e-n,t,this.far,this.coordinateSystem,this.reversedDepth),this.projectionMatrixInverse.copy(this.projectionMatrix).invert()}toJSON(t){let e=super.toJSON(t);return e.object.fov=this.fov,e.object.zoom=this.zoom,e.object.near=this.near,e.object.far=this.far,e.object.focus=this.focus,e.object.aspect=this.aspect,this.view!==null&&(e.object.view=Object.assign({},this.view)),e.object.filmGauge=this.filmGauge,e.object.filmOffset=this.filmOffset,e}};var Bl=class extends Ro{constructor(t=-1,e=1,n=1,s=-1,r=.1,o=2e3){super(),this.isOrthographicCamera=!0,this.type="OrthographicCamera",this.zoom=1,this.view=null,this.left=t,this.right=e,this.top=n,this.bottom=s,this.near=r,this.far=o,this.updateProjectionMatrix()}copy(t,e){return super.copy(t,e),this.left=t.left,this.right=t.right,this.top=t.top,this.bottom=t.bottom,this.near=t.near,this.far=t.far,this.zoom=t.zoom,this.view=t.view===null?null:Object.assign({},t.view),this}setViewOffset(t,e,n,s,r,o){this.view===null&&(this.view={enabled:!0,fullWidth:1,fullHeight:1,offsetX:0,offsetY:0,width:1,height:1}),this.view.enabled=!0,this.view.fullWidth=t,this.view.fullHeight=e,this.view.offsetX=n,this.view.offsetY=s,this.view.width=r,this.view.height=o,this.updateProjectionMatrix()}clearViewOffset(){this.view!==null&&(this.view.enabled=!1),this.updateProjectionMatrix()}updateProjectionMatrix(){let t=(this.right-this.left)/(2*this.zoom),e=(this.top-this.bottom)/(2*this.zoom),n=(this.right+this.left)/2,s=(this.top+this.bottom)/2,r=n-t,o=n+t,a=s+e,l=s-e;if(this.view!==null&&this.view.enabled){let c=(this.right-this.left)/this.view.fullWidth/this.zoom,h=(this.top-this.bottom)/this.view.fullHeight/this.zoom;r+=c*this.view.offsetX,o=r+c*this.view.width,a-=h*this.view.offsetY,l=a-h*this.view.height}this.projectionMatrix.makeOrthographic(r,o,a,l,this.near,this.far,this.coordinateSystem,this.reversedDepth),this.projectionMatrixInverse.copy(this.projectionMatrix).invert()}toJSON(t){let e=super.toJSON(t);return e.object.zoom=this.zoom,e.object.left=this.left,e.object.right=this.right,e.object.top=this.top,e.object.bottom=this.bottom,e.object.near=this.near,e.object.far=this.far,this.view!==null&&(e.object.view=Object.assign({},this.view)),e}};var ki=class extends Me{constructor(){super(),this.isInstancedBufferGeometry=!0,this.type="InstancedBufferGeometry",this.instanceCount=1/0}copy(t){return super.copy(t),this.instanceCount=t.instanceCount,this}toJSON(){let t=super.toJSON();return t.instanceCount=this.instanceCount,t.isInstancedBufferGeometry=!0,t}};var ar=-90,lr=1,vr=class extends Tn{constructor(t,e,n){super(),this.type="CubeCamera",this.renderTarget=n,this.coordinateSystem=null,this.activeMipmapLevel=0;let s=new _n(ar,lr,t,e);s.layers=this.layers,this.add(s);let r=new _n(ar,lr,t,e);r.layers=this.layers,this.add(r);let o=new _n(ar,lr,t,e);o.layers=this.layers,this.add(o);let a=new _n(ar,lr,t,e);a.layers=this.layers,this.add(a);let l=new _n(ar,lr,t,e);l.layers=this.layers,this.add(l);let c=new _n(ar,lr,t,e);c.layers=this.layers,this.add(c)}updateCoordinateSystem(){let t=this.coordinateSystem,e=this.children.concat(),[n,s,r,o,a,l]=e;for(let c of e)this.remove(c);if(t===Jn)n.up.set(0,1,0),n.lookAt(1,0,0),s.up.set(0,1,0),s.lookAt(-1,0,0),r.up.set(0,0,-1),r.lookAt(0,1,0),o.up.set(0,0,1),o.lookAt(0,-1,0),a.up.set(0,1,0),a.lookAt(0,0,1),l.up.set(0,1,0),l.lookAt(0,0,-1);else if(t===fo)n.up.set(0,-1,0),n.lookAt(-1,0,0),s.up.set(0,-1,0),s.lookAt(1,0,0),r.up.set(0,0,1),r.lookAt(0,1,0),o.up.set(0,0,-1),o.lookAt(0,-1,0),a.up.set(0,-1,0),a.lookAt(0,0,1),l.up.set(0,-1,0),l.lookAt(0,0,-1);else throw new Error("THREE.CubeCamera.updateCoordinateSystem(): Invalid coordinate system: "+t);for(let c of e)this.add(c),c.updateMatrixWorld()}update(t,e){this.parent===null&&this.updateMatrixWorld();let{renderTarget:n,activeMipmapLevel:s}=this;this.coordinateSystem!==t.coordinateSystem&&(this.coordinateSystem=t.coordinateSystem,this.updateCoordinateSystem());let[r,o,a,l,c,h]=this.children,u=t.getRenderTarget(),d=t.getActiveCubeFace(),f=t.getActiveMipmapLevel(),p=t.xr.enabled;t.xr.enabled=!1;let _=n.texture.mipmapsAutoUpdate;n.texture.mipmapsAutoUpdate=!1;let m=!1;t.isWebGLRenderer===!0?m=t.state.buffers.depth.getReversed():m=t.reversedDepthBuffer,t.setRenderTarget(n,0,s),m&&t.autoClear===!1&&t.clearDepth(),t.render(e,r),t.setRenderTarget(n,1,s),m&&t.autoClear===!1&&t.clearDepth(),t.render(e,o),t.setRenderTarget(n,2,s),m&&t.autoClear===!1&&t.clearDepth(),t.render(e,a),t.setRenderTarget(n,3,s),m&&t.autoClear===!1&&t.clearDepth(),t.render(e,l),t.setRenderTarget(n,4,s),m&&t.autoClear===!1&&t.clearDepth(),t.render(e,c),n.texture.mipmapsAutoUpdate=_,t.setRenderTarget(n,5,s),m&&t.autoClear===!1&&t.clearDepth(),t.render(e,h),t.setRenderTarget(u,d,f),t.xr.enabled=p,n.texture.needsPMREMUpdate=!0}},kl=class extends _n{constructor(t=[]){super(),this.isArrayCamera=!0,this.isMultiViewCamera=!1,this.cameras=t,this.perCameraFrustumCulled=!1}};var Yu="\\[\\]\\.:\\/",L_=new RegExp("["+Yu+"]","g"),Zu="[^"+Yu+"]",D_="[^"+Yu.replace("\\.","")+"]",N_=/((?:WC+[\/:])*)/.source.replace("WC",Zu),F_=/(WCOD+)?/.source.replace("WCOD",D_),U_=/(?:\.(WC+)(?:\[(.+)\])?)?/.source.replace("WC",Zu),O_=/\.(WC+)(?:\[(.+)\])?/.source.replace("WC",Zu),B_=new RegExp("^"+N_+F_+U_+O_+"$"),k_=["material","materials","bones","map"],fu=class{constructor(t,e,n){let s=n||_e.parseTrackName(e);this._targetGroup=t,this._bindings=t.subscribe_(e,s)}getValue(t,e){this.bind();let n=this._targetGroup.nCachedObjects_,s=this._bindings[n];s!==void 0&&s.getValue(t,e)}setValue(t,e){let n=this._bindings;for(let s=this._targetGroup.nCachedObjects_,r=n.length;s!==r;++s)n[s].setValue(t,e)}bind(){let t=this._bindings;for(let e=this._targetGroup.nCachedObjects_,n=t.length;e!==n;++e)t[e].bind()}unbind(){let t=this._bindings;for(let e=this._targetGroup.nCachedObjects_,n=t.length;e!==n;++e)t[e].unbind()}},_e=class i{constructor(t,e,n){this.path=e,this.parsedPath=n||i.parseTrackName(e),this.node=i.findNode(t,this.parsedPath.nodeName),this.rootNode=t,this.getValue=this._getValue_unbound,this.setValue=this._setValue_unbound}static create(t,e,n){return t&&t.isAnimationObjectGroup?new i.Composite(t,e,n):new i(t,e,n)}static sanitizeNodeName(t){return t.replace(/\s/g,"_").replace(L_,"")}static parseTrackName(t){let e=B_.exec(t);if(e===null)throw new Error("THREE.PropertyBinding: Cannot parse trackName: "+t);let n={nodeName:e[2],objectName:e[3],objectIndex:e[4],propertyName:e[5],propertyIndex:e[6]},s=n.nodeName&&n.nodeName.lastIndexOf(".");if(s!==void 0&&s!==-1){let r=n.nodeName.substring(s+1);k_.indexOf(r)!==-1&&(n.nodeName=n.nodeName.substring(0,s),n.objectName=r)}if(n.propertyName===null||n.propertyName.length===0)throw new Error("THREE.PropertyBinding: can not parse propertyName from trackName: "+t);return n}static findNode(t,e){if(e===void 0||e===""||e==="."||e===-1||e===t.name||e===t.uuid)return t;if(t.skeleton){let n=t.skeleton.getBoneByName(e);if(n!==void 0)return n}if(t.children){let n=function(r){for(let o=0;o<r.length;o++){let a=r[o];if(a.name===e||a.uuid===e)return a;let l=n(a.children);if(l)return l}return null},s=n(t.children);if(s)return s}return null}_getValue_unavailable(){}_setValue_unavailable(){}_getValue_direct(t,e){t[e]=this.targetObject[this.propertyName]}_getValue_array(t,e){let n=this.resolvedProperty;for(let s=0,r=n.length;s!==r;++s)t[e++]=n[s]}_getValue_arrayElement(t,e){t[e]=this.resolvedProperty[this.propertyIndex]}_getValue_toArray(t,e){this.resolvedProperty.toArray(t,e)}_setValue_direct(t,e){this.targetObject[this.propertyName]=t[e]}_setValue_direct_setNeedsUpdate(t,e){this.targetObject[this.propertyName]=t[e],this.targetObject.needsUpdate=!0}_setValue_direct_setMatrixWorldNeedsUpdate(t,e){this.targetObject[this.propertyName]=t[e],this.targetObject.matrixWorldNeedsUpdate=!0}_setValue_array(t,e){let n=this.resolvedProperty;for(let s=0,r=n.length;s!==r;++s)n[s]=t[e++]}_setValue_array_setNeedsUpdate(t,e){let n=this.resolvedProperty;for(let s=0,r=n.length;s!==r;++s)n[s]=t[e++];this.targetObject.needsUpdate=!0}_setValue_array_setMatrixWorldNeedsUpdate(t,e){let n=this.resolvedProperty;for(let s=0,r=n.length;s!==r;++s)n[s]=t[e++];this.targetObject.matrixWorldNeedsUpdate=!0}_setValue_arrayElement(t,e){this.resolvedProperty[this.propertyIndex]=t[e]}_setValue_arrayElement_setNeedsUpdate(t,e){this.resolvedProperty[this.propertyIndex]=t[e],this.targetObject.needsUpdate=!0}_setValue_arrayElement_setMatrixWorldNeedsUpdate(t,e){this.resolvedProperty[this.propertyIndex]=t[e],this.targetObject.matrixWorldNeedsUpdate=!0}_setValue_fromArray(t,e){this.resolvedProperty.fromArray(t,e)}_setValue_fromArray_setNeedsUpdate(t,e){this.resolvedProperty.fromArray(t,e),this.targetObject.needsUpdate=!0}_setValue_fromArray_setMatrixWorldNeedsUpdate(t,e){this.resolvedProperty.fromArray(t,e),this.targetObject.matrixWorldNeedsUpdate=!0}_getValue_unbound(t,e){this.bind(),this.getValue(t,e)}_setValue_unbound(t,e){this.bind(),this.setValue(t,e)}bind(){let t=this.node,e=this.parsedPath,n=e.objectName,s=e.propertyName,r=e.propertyIndex;if(t||(t=i.findNode(this.rootNode,e.nodeName),this.node=t),this.getValue=this._getValue_unavailable,this.setValue=this._setValue_unavailable,!t){It("PropertyBinding: No target node found for track: "+this.path+".");return}if(n){let c=e.objectIndex;switch(n){case"materials":if(!t.material){Nt("PropertyBinding: Can not bind to material as node does not have a material.",this);return}if(!t.material.materials){Nt("PropertyBinding: Can not bind to material.materials as node.material does not have a materials array.",this);return}t=t.material.materials;break;case"bones":if(!t.skeleton){Nt("PropertyBinding: Can not bind to bones as node does not have a skeleton.",this);return}t=t.skeleton.bones;for(let h=0;h<t.length;h++)if(t[h].name===c){c=h;break}break;case"map":if("map"in t){t=t.map;break}if(!t.material){Nt("PropertyBinding: Can not bind to material as node does not have a material.",this);return}if(!t.material.map){Nt("PropertyBinding: Can not bind to material.map as node.material does not have a map.",this);return}t=t.material.map;break;default:if(t[n]===void 0){Nt("PropertyBinding: Can not bind to objectName of node undefined.",this);return}t=t[n]}if(c!==void 0){if(t[c]===void 0){Nt("PropertyBinding: Trying to bind to objectIndex of objectName, but is undefined.",this,t);return}t=t[c]}}let o=t[s];if(o===void 0){let c=e.nodeName;Nt("PropertyBinding: Trying to update property for track: "+c+"."+s+" but it wasn't found.",t);return}let a=this.Versioning.None;this.targetObject=t,t.isMaterial===!0?a=this.Versioning.NeedsUpdate:t.isObject3D===!0&&(a=this.Versioning.MatrixWorldNeedsUpdate);let l=this.BindingType.Direct;if(r!==void 0){if(s==="morphTargetInfluences"){if(!t.geometry){Nt("PropertyBinding: Can not bind to morphTargetInfluences because node does not have a geometry.",this);return}if(!t.geometry.morphAttributes){Nt("PropertyBinding: Can not bind to morphTargetInfluences because node does not have a geometry.morphAttributes.",this);return}t.morphTargetDictionary[r]!==void 0&&(r=t.morphTargetDictionary[r])}l=this.BindingType.ArrayElement,this.resolvedProperty=o,this.propertyIndex=r}else o.fromArray!==void 0&&o.toArray!==void 0?(l=this.BindingType.HasFromToArray,this.resolvedProperty=o):Array.isArray(o)?(l=this.BindingType.EntireArray,this.resolvedProperty=o):this.propertyName=s;this.getValue=this.GetterByBindingType[l],this.setValue=this.SetterByBindingTypeAndVersioning[l][a]}unbind(){this.node=null,this.getValue=this._getValue_unbound,this.setValue=this._setValue_unbound}};_e.Composite=fu;_e.prototype.BindingType={Direct:0,EntireArray:1,ArrayElement:2,HasFromToArray:3};_e.prototype.Versioning={None:0,NeedsUpdate:1,MatrixWorldNeedsUpdate:2};_e.prototype.GetterByBindingType=[_e.prototype._getValue_direct,_e.prototype._getValue_array,_e.prototype._getValue_arrayElement,_e.prototype._getValue_toArray];_e.prototype.SetterByBindingTypeAndVersioning=[[_e.prototype._setValue_direct,_e.prototype._setValue_direct_setNeedsUpdate,_e.prototype._setValue_direct_setMatrixWorldNeedsUpdate],[_e.prototype._setValue_array,_e.prototype._setValue_array_setNeedsUpdate,_e.prototype._setValue_array_setMatrixWorldNeedsUpdate],[_e.prototype._setValue_arrayElement,_e.prototype._setValue_arrayElement_setNeedsUpdate,_e.prototype._setValue_arrayElement_setMatrixWorldNeedsUpdate],[_e.prototype._setValue_fromArray,_e.prototype._setValue_fromArray_setNeedsUpdate,_e.prototype._setValue_fromArray_setMatrixWorldNeedsUpdate]];var Dw=new Float32Array(1);var zi=class extends xl{constructor(t,e,n=1){super(t,e),this.isInstancedInterleavedBuffer=!0,this.meshPerAttribute=n}copy(t){return super.copy(t),this.meshPerAttribute=t.meshPerAttribute,this}clone(t){let e=super.clone(t);return e.meshPerAttribute=this.meshPerAttribute,e}toJSON(t){let e=super.toJSON(t);return e.isInstancedInterleavedBuffer=!0,e.meshPerAttribute=this.meshPerAttribute,e}};var Pp=new Pt,Co=class{constructor(t,e,n=0,s=1/0){this.ray=new ri(t,e),this.near=n,this.far=s,this.camera=null,this.layers=new yr,this.params={Mesh:{},Line:{threshold:1},LOD:{},Points:{threshold:1},Sprite:{}}}set(t,e){this.ray.set(t,e)}setFromCamera(t,e){e.isPerspectiveCamera?(this.ray.origin.setFromMatrixPosition(e.matrixWorld),this.ray.direction.set(t.x,t.y,.5).unproject(e).sub(this.ray.origin).normalize(),this.camera=e):e.isOrthographicCamera?(this.ray.origin.set(t.x,t.y,e.projectionMatrix.elements[14]).unproject(e),this.ray.direction.set(0,0,-1).transformDirection(e.matrixWorld),this.camera=e):Nt("Raycaster: Unsupported camera type: "+e.type)}setFromXRController(t){return Pp.identity().extractRotation(t.matrixWorld),this.ray.origin.setFromMatrixPosition(t.matrixWorld),this.ray.direction.set(0,0,-1).applyMatrix4(Pp),this}intersectObject(t,e=!0,n=[]){return pu(t,this,n,e),n.sort(Ip),n}intersectObjects(t,e=!0,n=[]){for(let s=0,r=t.length;s<r;s++)pu(t[s],this,n,e);return n.sort(Ip),n}};function Ip(i,t){return i.distance-t.distance}function pu(i,t,e,n){let s=!0;if(i.layers.test(t.layers)&&i.raycast(t,e)===!1&&(s=!1),s===!0&&n===!0){let r=i.children;for(let o=0,a=r.length;o<a;o++)pu(r[o],t,e,!0)}}var br=class{constructor(t=1,e=0,n=0){this.radius=t,this.phi=e,this.theta=n}set(t,e,n){return this.radius=t,this.phi=e,this.theta=n,this}copy(t){return this.radius=t.radius,this.phi=t.phi,this.theta=t.theta,this}makeSafe(){return this.phi=Vt(this.phi,1e-6,Math.PI-1e-6),this}setFromVector3(t){return this.setFromCartesianCoords(t.x,t.y,t.z)}setFromCartesianCoords(t,e,n){return this.radius=Math.sqrt(t*t+e*e+n*n),this.radius===0?(this.theta=0,this.phi=0):(this.theta=Math.atan2(t,n),this.phi=Math.acos(Vt(e/this.radius,-1,1))),this}clone(){return new this.constructor().copy(this)}};var mu=class{static{this.prototype.isMatrix2=!0}constructor(t,e,n,s){this.elements=[1,0,0,1],t!==void 0&&this.set(t,e,n,s)}identity(){return this.set(1,0,0,1),this}fromArray(t,e=0){for(let n=0;n<4;n++)this.elements[n]=t[n+e];return this}set(t,e,n,s){let r=this.elements;return r[0]=t,r[2]=e,r[1]=n,r[3]=s,this}};var Lp=new C,sl=new C,cr=new C,hr=new C,au=new C,z_=new C,V_=new C,vn=class{constructor(t=new C,e=new C){this.start=t,this.end=e}set(t,e){return this.start.copy(t),this.end.copy(e),this}copy(t){return this.start.copy(t.start),this.end.copy(t.end),this}getCenter(t){return t.addVectors(this.start,this.end).multiplyScalar(.5)}delta(t){return t.subVectors(this.end,this.start)}distanceSq(){return this.start.distanceToSquared(this.end)}distance(){return this.start.distanceTo(this.end)}at(t,e){return this.delta(e).multiplyScalar(t).add(this.start)}closestPointToPointParameter(t,e){Lp.subVectors(t,this.start),sl.subVectors(this.end,this.start);let n=sl.dot(sl);if(n===0)return 0;let r=sl.dot(Lp)/n;return e&&(r=Vt(r,0,1)),r}closestPointToPoint(t,e,n){let s=this.closestPointToPointParameter(t,e);return this.delta(n).multiplyScalar(s).add(this.start)}distanceSqToLine3(t,e=z_,n=V_){let s=10000000000000001e-32,r,o,a=this.start,l=t.start,c=this.end,h=t.end;cr.subVectors(c,a),hr.subVectors(h,l),au.subVectors(a,l);let u=cr.dot(cr),d=hr.dot(hr),f=hr.dot(au);if(u<=s&&d<=s)return e.copy(a),n.copy(l),e.distanceToSquared(n);if(u<=s)r=0,o=f/d,o=Vt(o,0,1);else{let p=cr.dot(au);if(d<=s)o=0,r=Vt(-p/u,0,1);else{let _=cr.dot(hr),m=u*d-_*_;m!==0?r=Vt((_*f-p*d)/m,0,1):r=0,o=(_*r+f)/d,o<0?(o=0,r=Vt(-p/u,0,1)):o>1&&(o=1,r=Vt((_-p)/u,0,1))}}return e.copy(a).addScaledVector(cr,r),n.copy(l).addScaledVector(hr,o),e.distanceToSquared(n)}applyMatrix4(t){return this.start.applyMatrix4(t),this.end.applyMatrix4(t),this}equals(t){return t.start.equals(this.start)&&t.end.equals(this.end)}clone(){return new this.constructor().copy(this)}};var Po=class extends si{constructor(t,e=null){super(),this.object=t,this.domElement=e,this.enabled=!0,this.state=-1,this.keys={},this.mouseButtons={LEFT:null,MIDDLE:null,RIGHT:null},this.touches={ONE:null,TWO:null}}connect(t){this.domElement!==null&&this.disconnect(),this.domElement=t}disconnect(){}dispose(){}update(){}};function Ju(i,t,e,n){let s=G_(n);switch(e){case Fu:return i*t;case Do:return i*t/s.components*s.byteLength;case Xl:return i*t/s.components*s.byteLength;case _i:return i*t*2/s.components*s.byteLength;case ql:return i*t*2/s.components*s.byteLength;case Uu:return i*t*3/s.components*s.byteLength;case sn:return i*t*4/s.components*s.byteLength;case Yl:return i*t*4/s.components*s.byteLength;case No:case Fo:return Math.floor((i+3)/4)*Math.floor((t+3)/4)*8;case Uo:case Oo:return Math.floor((i+3)/4)*Math.floor((t+3)/4)*16;case Jl:case jl:return Math.max(i,16)*Math.max(t,8)/4;case Zl:case Kl:return Math.max(i,8)*Math.max(t,8)/2;case Ql:case tc:case nc:case ic:return Math.floor((i+3)/4)*Math.floor((t+3)/4)*8;case ec:case Bo:case sc:return Math.floor((i+3)/4)*Math.floor((t+3)/4)*16;case rc:return Math.floor((i+3)/4)*Math.floor((t+3)/4)*16;case oc:return Math.floor((i+4)/5)*Math.floor((t+3)/4)*16;case ac:return Math.floor((i+4)/5)*Math.floor((t+4)/5)*16;case lc:return Math.floor((i+5)/6)*Math.floor((t+4)/5)*16;case cc:return Math.floor((i+5)/6)*Math.floor((t+5)/6)*16;case hc:return Math.floor((i+7)/8)*Math.floor((t+4)/5)*16;case uc:return Math.floor((i+7)/8)*Math.floor((t+5)/6)*16;case dc:return Math.floor((i+7)/8)*Math.floor((t+7)/8)*16;case fc:return Math.floor((i+9)/10)*Math.floor((t+4)/5)*16;case pc:return Math.floor((i+9)/10)*Math.floor((t+5)/6)*16;case mc:return Math.floor((i+9)/10)*Math.floor((t+7)/8)*16;case gc:return Math.floor((i+9)/10)*Math.floor((t+9)/10)*16;case _c:return Math.floor((i+11)/12)*Math.floor((t+9)/10)*16;case yc:return Math.floor((i+11)/12)*Math.floor((t+11)/12)*16;case xc:case vc:case bc:return Math.ceil(i/4)*Math.ceil(t/4)*16;case Sc:case Mc:return Math.ceil(i/4)*Math.ceil(t/4)*8;case ko:case wc:return Math.ceil(i/4)*Math.ceil(t/4)*16}throw new Error(`Unable to determine texture byte length for ${e} format.`)}function G_(i){switch(i){case Bn:case Iu:return{byteLength:1,components:1};case Ar:case Lu:case li:return{byteLength:2,components:1};case Wl:case $l:return{byteLength:2,components:4};case ai:case Hl:case Rn:return{byteLength:4,components:1};case Du:case Nu:return{byteLength:4,components:3}}throw new Error(`THREE.TextureUtils: Unknown texture type ${i}.`)}typeof __THREE_DEVTOOLS__<"u"&&__THREE_DEVTOOLS__.dispatchEvent(new CustomEvent("register",{detail:{revision:"187"}}));typeof window<"u"&&(window.__THREE__?It("WARNING: Multiple instances of Three.js being imported."):window.__THREE__="187");function zm(){let i=null,t=!1,e=null,n=null;function s(r,o){n=i.requestAnimationFrame(s),e(r,o)}return{start:function(){t!==!0&&e!==null&&i!==null&&(n=i.requestAnimationFrame(s),t=!0)},stop:function(){i!==null&&i.cancelAnimationFrame(n),t=!1},setAnimationLoop:function(r){e=r},setContext:function(r){i=r}}}function H_(i){let t=new WeakMap;function e(a,l){let c=a.array,h=a.usage,u=c.byteLength,d=i.createBuffer();i.bindBuffer(l,d),i.bufferData(l,c,h),a.onUploadCallback();let f;if(c instanceof Float32Array)f=i.FLOAT;else if(typeof Float16Array<"u"&&c instanceof Float16Array)f=i.HALF_FLOAT;else if(c instanceof Uint16Array)a.isFloat16BufferAttribute?f=i.HALF_FLOAT:f=i.UNSIGNED_SHORT;else if(c instanceof Int16Array)f=i.SHORT;else if(c instanceof Uint32Array)f=i.UNSIGNED_INT;else if(c instanceof Int32Array)f=i.INT;else if(c instanceof Int8Array)f=i.BYTE;else if(c instanceof Uint8Array)f=i.UNSIGNED_BYTE;else if(c instanceof Uint8ClampedArray)f=i.UNSIGNED_BYTE;else throw new Error("THREE.WebGLAttributes: Unsupported buffer data format: "+c);return{buffer:d,type:f,bytesPerElement:c.BYTES_PER_ELEMENT,version:a.version,size:u}}function n(a,l,c){let h=l.array,u=l.updateRanges;if(i.bindBuffer(c,a),u.length===0)i.bufferSubData(c,0,h);else{u.sort((f,p)=>f.start-p.start);let d=0;for(let f=1;f<u.length;f++){let p=u[d],_=u[f];_.start<=p.start+p.count+1?p.count=Math.max(p.count,_.start+_.count-p.start):(++d,u[d]=_)}u.length=d+1;for(let f=0,p=u.length;f<p;f++){let _=u[f];i.bufferSubData(c,_.start*h.BYTES_PER_ELEMENT,h,_.start,_.count)}l.clearUpdateRanges()}l.onUploadCallback()}function s(a){return a.isInterleavedBufferAttribute&&(a=a.data),t.get(a)}function r(a){a.isInterleavedBufferAttribute&&(a=a.data);let l=t.get(a);l&&(i.deleteBuffer(l.buffer),t.delete(a))}function o(a,l){if(a.isInterleavedBufferAttribute&&(a=a.data),a.isGLBufferAttribute){let h=t.get(a);(!h||h.version<a.version)&&t.set(a,{buffer:a.buffer,type:a.type,bytesPerElement:a.elementSize,version:a.version});return}let c=t.get(a);if(c===void 0)t.set(a,e(a,l));else if(c.version<a.version){if(c.size!==a.array.byteLength)throw new Error("THREE.WebGLAttributes: The size of the buffer attribute's array buffer does not match the original size. Resizing buffer attributes is not supported.");n(c.buffer,a,l),c.version=a.version}}return{get:s,remove:r,update:o}}var W_=`#ifdef USE_ALPHAHASH
	if ( diffuseColor.a < getAlphaHashThreshold( vPosition ) ) discard;
#endif`,$_=`#ifdef USE_ALPHAHASH
	const float ALPHA_HASH_SCALE = 0.05;
	float hash2D( vec2 value ) {
		return fract( 1.0e4 * sin( 17.0 * value.x + 0.1 * value.y ) * ( 0.1 + abs( sin( 13.0 * value.y + value.x ) ) ) );
	}
	float hash3D( vec3 value ) {
		return hash2D( vec2( hash2D( value.xy ), value.z ) );
	}
	float getAlphaHashThreshold( vec3 position ) {
		float maxDeriv = max(
			length( dFdx( position.xyz ) ),
			length( dFdy( position.xyz ) )
		);
		float pixScale = 1.0 / ( ALPHA_HASH_SCALE * maxDeriv );
		vec2 pixScales = vec2(
			exp2( floor( log2( pixScale ) ) ),
			exp2( ceil( log2( pixScale ) ) )
		);
		vec2 alpha = vec2(
			hash3D( floor( pixScales.x * position.xyz ) ),
			hash3D( floor( pixScales.y * position.xyz ) )
		);
		float lerpFactor = fract( log2( pixScale ) );
		float x = ( 1.0 - lerpFactor ) * alpha.x + lerpFactor * alpha.y;
		float a = min( lerpFactor, 1.0 - lerpFactor );
		vec3 cases = vec3(
			x * x / ( 2.0 * a * ( 1.0 - a ) ),
			( x - 0.5 * a ) / ( 1.0 - a ),
			1.0 - ( ( 1.0 - x ) * ( 1.0 - x ) / ( 2.0 * a * ( 1.0 - a ) ) )
		);
		float threshold = ( x < ( 1.0 - a ) )
			? ( ( x < a ) ? cases.x : cases.y )
			: cases.z;
		return clamp( threshold , 1.0e-6, 1.0 );
	}
#endif`,X_=`#ifdef USE_ALPHAMAP
	diffuseColor.a *= texture2D( alphaMap, vAlphaMapUv ).g;
#endif`,q_=`#ifdef USE_ALPHAMAP
	uniform sampler2D alphaMap;
#endif`,Y_=`#ifdef USE_ALPHATEST
	#ifdef ALPHA_TO_COVERAGE
	diffuseColor.a = smoothstep( alphaTest, alphaTest + fwidth( diffuseColor.a ), diffuseColor.a );
	if ( diffuseColor.a == 0.0 ) discard;
	#else
	if ( diffuseColor.a < alphaTest ) discard;
	#endif
#endif`,Z_=`#ifdef USE_ALPHATEST
	uniform float alphaTest;
#endif`,J_=`#ifdef USE_AOMAP
	float ambientOcclusion = ( texture2D( aoMap, vAoMapUv ).r - 1.0 ) * aoMapIntensity + 1.0;
	reflectedLight.indirectDiffuse *= ambientOcclusion;
	#if defined( USE_CLEARCOAT ) 
		clearcoatSpecularIndirect *= ambientOcclusion;
	#endif
	#if defined( USE_SHEEN ) 
		sheenSpecularIndirect *= ambientOcclusion;
	#endif
	#if defined( USE_ENVMAP ) && defined( STANDARD )
		float dotNV = saturate( dot( geometryNormal, geometryViewDir ) );
		reflectedLight.indirectSpecular *= computeSpecularOcclusion( dotNV, ambientOcclusion, material.roughness );
	#endif
#endif`,K_=`#ifdef USE_AOMAP
	uniform sampler2D aoMap;
	uniform float aoMapIntensity;
#endif`,j_=`#ifdef USE_BATCHING
	#if ! defined( GL_ANGLE_multi_draw )
	#define gl_DrawID _gl_DrawID
	uniform int _gl_DrawID;
	#endif
	uniform highp sampler2D batchingTexture;
	uniform highp usampler2D batchingIdTexture;
	mat4 getBatchingMatrix( const in float i ) {
		int size = textureSize( batchingTexture, 0 ).x;
		int j = int( i ) * 4;
		int x = j % size;
		int y = j / size;
		vec4 v1 = texelFetch( batchingTexture, ivec2( x, y ), 0 );
		vec4 v2 = texelFetch( batchingTexture, ivec2( x + 1, y ), 0 );
		vec4 v3 = texelFetch( batchingTexture, ivec2( x + 2, y ), 0 );
		vec4 v4 = texelFetch( batchingTexture, ivec2( x + 3, y ), 0 );
		return mat4( v1, v2, v3, v4 );
	}
	float getIndirectIndex( const in int i ) {
		int size = textureSize( batchingIdTexture, 0 ).x;
		int x = i % size;
		int y = i / size;
		return float( texelFetch( batchingIdTexture, ivec2( x, y ), 0 ).r );
	}
#endif
#ifdef USE_BATCHING_COLOR
	uniform sampler2D batchingColorTexture;
	vec4 getBatchingColor( const in float i ) {
		int size = textureSize( batchingColorTexture, 0 ).x;
		int j = int( i );
		int x = j % size;
		int y = j / size;
		return texelFetch( batchingColorTexture, ivec2( x, y ), 0 );
	}
#endif`,Q_=`#ifdef USE_BATCHING
	mat4 batchingMatrix = getBatchingMatrix( getIndirectIndex( gl_DrawID ) );
#endif`,ty=`vec3 transformed = vec3( position );
#ifdef USE_ALPHAHASH
	vPosition = vec3( position );
#endif`,ey=`vec3 objectNormal = vec3( normal );
#ifdef USE_TANGENT
	vec3 objectTangent = vec3( tangent.xyz );
#endif`,ny=`float G_BlinnPhong_Implicit( ) {
	return 0.25;
}
float D_BlinnPhong( const in float shininess, const in float dotNH ) {
	return RECIPROCAL_PI * ( shininess * 0.5 + 1.0 ) * pow( dotNH, shininess );
}
vec3 BRDF_BlinnPhong( const in vec3 lightDir, const in vec3 viewDir, const in vec3 normal, const in vec3 specularColor, const in float shininess ) {
	vec3 halfDir = normalize( lightDir + viewDir );
	float dotNH = saturate( dot( normal, halfDir ) );
	float dotVH = saturate( dot( viewDir, halfDir ) );
	vec3 F = F_Schlick( specularColor, 1.0, dotVH );
	float G = G_BlinnPhong_Implicit( );
	float D = D_BlinnPhong( shininess, dotNH );
	return F * ( G * D );
} // validated`,iy=`#ifdef USE_IRIDESCENCE
	const mat3 XYZ_TO_REC709 = mat3(
		 3.2404542, -0.9692660,  0.0556434,
		-1.5371385,  1.8760108, -0.2040259,
		-0.4985314,  0.0415560,  1.0572252
	);
	vec3 Fresnel0ToIor( vec3 fresnel0 ) {
		vec3 sqrtF0 = sqrt( fresnel0 );
		return ( vec3( 1.0 ) + sqrtF0 ) / ( vec3( 1.0 ) - sqrtF0 );
	}
	vec3 IorToFresnel0( vec3 transmittedIor, float incidentIor ) {
		return pow2( ( transmittedIor - vec3( incidentIor ) ) / ( transmittedIor + vec3( incidentIor ) ) );
	}
	float IorToFresnel0( float transmittedIor, float incidentIor ) {
		return pow2( ( transmittedIor - incidentIor ) / ( transmittedIor + incidentIor ));
	}
	vec3 evalSensitivity( float OPD, vec3 shift ) {
		float phase = 2.0 * PI * OPD * 1.0e-9;
		vec3 val = vec3( 5.4856e-13, 4.4201e-13, 5.2481e-13 );
		vec3 pos = vec3( 1.6810e+06, 1.7953e+06, 2.2084e+06 );
		vec3 var = vec3( 4.3278e+09, 9.3046e+09, 6.6121e+09 );
		vec3 xyz = val * sqrt( 2.0 * PI * var ) * cos( pos * phase + shift ) * exp( - pow2( phase ) * var );
		xyz.x += 9.7470e-14 * sqrt( 2.0 * PI * 4.5282e+09 ) * cos( 2.2399e+06 * phase + shift[ 0 ] ) * exp( - 4.5282e+09 * pow2( phase ) );
		xyz /= 1.0685e-7;
		vec3 rgb = XYZ_TO_REC709 * xyz;
		return rgb;
	}
	vec3 evalIridescence( float outsideIOR, float eta2, float cosTheta1, float thinFilmThickness, vec3 baseF0 ) {
		vec3 I;
		float iridescenceIOR = mix( outsideIOR, eta2, smoothstep( 0.0, 0.03, thinFilmThickness ) );
		float sinTheta2Sq = pow2( outsideIOR / iridescenceIOR ) * ( 1.0 - pow2( cosTheta1 ) );
		float cosTheta2Sq = 1.0 - sinTheta2Sq;
		if ( cosTheta2Sq < 0.0 ) {
			return vec3( 1.0 );
		}
		float cosTheta2 = sqrt( cosTheta2Sq );
		float R0 = IorToFresnel0( iridescenceIOR, outsideIOR );
		float R12 = F_Schlick( R0, 1.0, cosTheta1 );
		float T121 = 1.0 - R12;
		float phi12 = 0.0;
		if ( iridescenceIOR < outsideIOR ) phi12 = PI;
		float phi21 = PI - phi12;
		vec3 baseIOR = Fresnel0ToIor( clamp( baseF0, 0.0, 0.9999 ) );		vec3 R1 = IorToFresnel0( baseIOR, iridescenceIOR );
		vec3 R23 = F_Schlick( R1, 1.0, cosTheta2 );
		vec3 phi23 = vec3( 0.0 );
		if ( baseIOR[ 0 ] < iridescenceIOR ) phi23[ 0 ] = PI;
		if ( baseIOR[ 1 ] < iridescenceIOR ) phi23[ 1 ] = PI;
		if ( baseIOR[ 2 ] < iridescenceIOR ) phi23[ 2 ] = PI;
		float OPD = 2.0 * iridescenceIOR * thinFilmThickness * cosTheta2;
		vec3 phi = vec3( phi21 ) + phi23;
		vec3 R123 = clamp( R12 * R23, 1e-5, 0.9999 );
		vec3 r123 = sqrt( R123 );
		vec3 Rs = pow2( T121 ) * R23 / ( vec3( 1.0 ) - R123 );
		vec3 C0 = R12 + Rs;
		I = C0;
		vec3 Cm = Rs - T121;
		for ( int m = 1; m <= 2; ++ m ) {
			Cm *= r123;
			vec3 Sm = 2.0 * evalSensitivity( float( m ) * OPD, float( m ) * phi );
			I += Cm * Sm;
		}
		return max( I, vec3( 0.0 ) );
	}
#endif`,sy=`#ifdef USE_BUMPMAP
	uniform sampler2D bumpMap;
	uniform float bumpScale;
	vec2 dHdxy_fwd() {
		vec2 dSTdx = dFdx( vBumpMapUv );
		vec2 dSTdy = dFdy( vBumpMapUv );
		float Hll = bumpScale * texture2D( bumpMap, vBumpMapUv ).x;
		float dBx = bumpScale * texture2D( bumpMap, vBumpMapUv + dSTdx ).x - Hll;
		float dBy = bumpScale * texture2D( bumpMap, vBumpMapUv + dSTdy ).x - Hll;
		return vec2( dBx, dBy );
	}
	vec3 perturbNormalArb( vec3 surf_pos, vec3 surf_norm, vec2 dHdxy, float faceDirection ) {
		vec3 vSigmaX = normalize( dFdx( surf_pos.xyz ) );
		vec3 vSigmaY = normalize( dFdy( surf_pos.xyz ) );
		vec3 vN = surf_norm;
		vec3 R1 = cross( vSigmaY, vN );
		vec3 R2 = cross( vN, vSigmaX );
		float fDet = dot( vSigmaX, R1 ) * faceDirection;
		vec3 vGrad = sign( fDet ) * ( dHdxy.x * R1 + dHdxy.y * R2 );
		return normalize( abs( fDet ) * surf_norm - vGrad );
	}
#endif`,ry=`#if NUM_CLIPPING_PLANES > 0
	vec4 plane;
	#ifdef ALPHA_TO_COVERAGE
		float distanceToPlane, distanceGradient;
		float clipOpacity = 1.0;
		#pragma unroll_loop_start
		for ( int i = 0; i < UNION_CLIPPING_PLANES; i ++ ) {
			plane = clippingPlanes[ i ];
			distanceToPlane = - dot( vClipPosition, plane.xyz ) + plane.w;
			distanceGradient = fwidth( distanceToPlane ) / 2.0;
			clipOpacity *= smoothstep( - distanceGradient, distanceGradient, distanceToPlane );
			if ( clipOpacity == 0.0 ) discard;
		}
		#pragma unroll_loop_end
		#if UNION_CLIPPING_PLANES < NUM_CLIPPING_PLANES
			float unionClipOpacity = 1.0;
			#pragma unroll_loop_start
			for ( int i = UNION_CLIPPING_PLANES; i < NUM_CLIPPING_PLANES; i ++ ) {
				plane = clippingPlanes[ i ];
				distanceToPlane = - dot( vClipPosition, plane.xyz ) + plane.w;
				distanceGradient = fwidth( distanceToPlane ) / 2.0;
				unionClipOpacity *= 1.0 - smoothstep( - distanceGradient, distanceGradient, distanceToPlane );
			}
			#pragma unroll_loop_end
			clipOpacity *= 1.0 - unionClipOpacity;
		#endif
		diffuseColor.a *= clipOpacity;
		if ( diffuseColor.a == 0.0 ) discard;
	#else
		#pragma unroll_loop_start
		for ( int i = 0; i < UNION_CLIPPING_PLANES; i ++ ) {
			plane = clippingPlanes[ i ];
			if ( dot( vClipPosition, plane.xyz ) > plane.w ) discard;
		}
		#pragma unroll_loop_end
		#if UNION_CLIPPING_PLANES < NUM_CLIPPING_PLANES
			bool clipped = true;
			#pragma unroll_loop_start
			for ( int i = UNION_CLIPPING_PLANES; i < NUM_CLIPPING_PLANES; i ++ ) {
				plane = clippingPlanes[ i ];
				clipped = ( dot( vClipPosition, plane.xyz ) > plane.w ) && clipped;
			}
			#pragma unroll_loop_end
			if ( clipped ) discard;
		#endif
	#endif
#endif`,oy=`#if NUM_CLIPPING_PLANES > 0
	varying vec3 vClipPosition;
	uniform vec4 clippingPlanes[ NUM_CLIPPING_PLANES ];
#endif`,ay=`#if NUM_CLIPPING_PLANES > 0
	varying vec3 vClipPosition;
#endif`,ly=`#if NUM_CLIPPING_PLANES > 0
	vClipPosition = - mvPosition.xyz;
#endif`,cy=`#if defined( USE_COLOR ) || defined( USE_COLOR_ALPHA )
	diffuseColor *= vColor;
#endif`,hy=`#if defined( USE_COLOR ) || defined( USE_COLOR_ALPHA )
	varying vec4 vColor;
#endif`,uy=`#if defined( USE_COLOR ) || defined( USE_COLOR_ALPHA ) || defined( USE_INSTANCING_COLOR ) || defined( USE_BATCHING_COLOR )
	varying vec4 vColor;
#endif`,dy=`#if defined( USE_COLOR ) || defined( USE_COLOR_ALPHA ) || defined( USE_INSTANCING_COLOR ) || defined( USE_BATCHING_COLOR )
	vColor = vec4( 1.0 );
#endif
#ifdef USE_COLOR_ALPHA
	vColor *= color;
#elif defined( USE_COLOR )
	vColor.rgb *= color;
#endif
#ifdef USE_INSTANCING_COLOR
	vColor.rgb *= instanceColor.rgb;
#endif
#ifdef USE_BATCHING_COLOR
	vColor *= getBatchingColor( getIndirectIndex( gl_DrawID ) );
#endif`,fy=`#define PI 3.141592653589793
#define PI2 6.283185307179586
#define PI_HALF 1.5707963267948966
#define RECIPROCAL_PI 0.3183098861837907
#define RECIPROCAL_PI2 0.15915494309189535
#define EPSILON 1e-6
#ifndef saturate
#define saturate( a ) clamp( a, 0.0, 1.0 )
#endif
#define whiteComplement( a ) ( 1.0 - saturate( a ) )
float pow2( const in float x ) { return x*x; }
vec3 pow2( const in vec3 x ) { return x*x; }
float pow3( const in float x ) { return x*x*x; }
float pow4( const in float x ) { float x2 = x*x; return x2*x2; }
float max3( const in vec3 v ) { return max( max( v.x, v.y ), v.z ); }
float average( const in vec3 v ) { return dot( v, vec3( 0.3333333 ) ); }
highp float rand( const in vec2 uv ) {
	const highp float a = 12.9898, b = 78.233, c = 43758.5453;
	highp float dt = dot( uv.xy, vec2( a,b ) ), sn = mod( dt, PI );
	return fract( sin( sn ) * c );
}
#ifdef HIGH_PRECISION
	float precisionSafeLength( vec3 v ) { return length( v ); }
#else
	float precisionSafeLength( vec3 v ) {
		float maxComponent = max3( abs( v ) );
		return length( v / maxComponent ) * maxComponent;
	}
#endif
struct IncidentLight {
	vec3 color;
	vec3 direction;
	bool visible;
};
struct ReflectedLight {
	vec3 directDiffuse;
	vec3 directSpecular;
	vec3 indirectDiffuse;
	vec3 indirectSpecular;
};
#ifdef USE_ALPHAHASH
	varying vec3 vPosition;
#endif
vec3 transformDirection( in vec3 dir, in mat4 matrix ) {
	return normalize( ( matrix * vec4( dir, 0.0 ) ).xyz );
}
#define inverseTransformDirection transformDirectionByInverseViewMatrix
vec3 transformNormalByInverseViewMatrix( in vec3 normal, in mat4 viewMatrix ) {
	return normalize( ( vec4( normal, 0.0 ) * viewMatrix ).xyz );
}
vec3 transformDirectionByInverseViewMatrix( in vec3 dir, in mat4 viewMatrix ) {
	return normalize( ( vec4( dir, 0.0 ) * viewMatrix ).xyz );
}
bool isPerspectiveMatrix( mat4 m ) {
	return m[ 2 ][ 3 ] == - 1.0;
}
vec2 equirectUv( in vec3 dir ) {
	float u = atan( dir.z, dir.x ) * RECIPROCAL_PI2 + 0.5;
	float v = asin( clamp( dir.y, - 1.0, 1.0 ) ) * RECIPROCAL_PI + 0.5;
	return vec2( u, v );
}
vec3 BRDF_Lambert( const in vec3 diffuseColor ) {
	return RECIPROCAL_PI * diffuseColor;
}
vec3 F_Schlick( const in vec3 f0, const in float f90, const in float dotVH ) {
	float fresnel = exp2( ( - 5.55473 * dotVH - 6.98316 ) * dotVH );
	return f0 * ( 1.0 - fresnel ) + ( f90 * fresnel );
}
float F_Schlick( const in float f0, const in float f90, const in float dotVH ) {
	float fresnel = exp2( ( - 5.55473 * dotVH - 6.98316 ) * dotVH );
	return f0 * ( 1.0 - fresnel ) + ( f90 * fresnel );
} // validated`,py=`vec3 transformedNormal = objectNormal;
#ifdef USE_TANGENT
	vec3 transformedTangent = objectTangent;
#endif
#ifdef USE_BATCHING
	mat3 bm = mat3( batchingMatrix );
	transformedNormal /= vec3( dot( bm[ 0 ], bm[ 0 ] ), dot( bm[ 1 ], bm[ 1 ] ), dot( bm[ 2 ], bm[ 2 ] ) );
	transformedNormal = bm * transformedNormal;
	#ifdef USE_TANGENT
		transformedTangent = bm * transformedTangent;
	#endif
#endif
#ifdef USE_INSTANCING
	mat3 im = mat3( instanceMatrix );
	transformedNormal /= vec3( dot( im[ 0 ], im[ 0 ] ), dot( im[ 1 ], im[ 1 ] ), dot( im[ 2 ], im[ 2 ] ) );
	transformedNormal = im * transformedNormal;
	#ifdef USE_TANGENT
		transformedTangent = im * transformedTangent;
	#endif
#endif
transformedNormal = normalMatrix * transformedNormal;
#ifdef FLIP_SIDED
	transformedNormal = - transformedNormal;
#endif
#ifdef USE_TANGENT
	transformedTangent = ( modelViewMatrix * vec4( transformedTangent, 0.0 ) ).xyz;
#endif`,my=`#ifdef USE_DISPLACEMENTMAP
	uniform sampler2D displacementMap;
	uniform float displacementScale;
	uniform float displacementBias;
#endif`,gy=`#ifdef USE_DISPLACEMENTMAP
	transformed += normalize( objectNormal ) * ( texture2D( displacementMap, vDisplacementMapUv ).x * displacementScale + displacementBias );
#endif`,_y=`#ifdef USE_EMISSIVEMAP
	vec4 emissiveColor = texture2D( emissiveMap, vEmissiveMapUv );
	#ifdef DECODE_VIDEO_TEXTURE_EMISSIVE
		emissiveColor = sRGBTransferEOTF( emissiveColor );
	#endif
	totalEmissiveRadiance *= emissiveColor.rgb;
#endif`,yy=`#ifdef USE_EMISSIVEMAP
	uniform sampler2D emissiveMap;
#endif`,xy="gl_FragColor = linearToOutputTexel( gl_FragColor );",vy=`vec4 LinearTransferOETF( in vec4 value ) {
	return value;
}
vec4 sRGBTransferEOTF( in vec4 value ) {
	return vec4( mix( pow( value.rgb * 0.9478672986 + vec3( 0.0521327014 ), vec3( 2.4 ) ), value.rgb * 0.0773993808, vec3( lessThanEqual( value.rgb, vec3( 0.04045 ) ) ) ), value.a );
}
vec4 sRGBTransferOETF( in vec4 value ) {
	return vec4( mix( pow( value.rgb, vec3( 0.41666 ) ) * 1.055 - vec3( 0.055 ), value.rgb * 12.92, vec3( lessThanEqual( value.rgb, vec3( 0.0031308 ) ) ) ), value.a );
}`,by=`#ifdef USE_ENVMAP
	#ifdef ENV_WORLDPOS
		vec3 cameraToFrag;
		if ( isOrthographic ) {
			cameraToFrag = normalize( vec3( - viewMatrix[ 0 ][ 2 ], - viewMatrix[ 1 ][ 2 ], - viewMatrix[ 2 ][ 2 ] ) );
		} else {
			cameraToFrag = normalize( vWorldPosition - cameraPosition );
		}
		vec3 worldNormal = transformNormalByInverseViewMatrix( normal, viewMatrix );
		#ifdef ENVMAP_MODE_REFLECTION
			vec3 reflectVec = reflect( cameraToFrag, worldNormal );
		#else
			vec3 reflectVec = refract( cameraToFrag, worldNormal, refractionRatio );
		#endif
	#else
		vec3 reflectVec = vReflect;
	#endif
	#ifdef ENVMAP_TYPE_CUBE
		vec4 envColor = textureCube( envMap, envMapRotation * reflectVec );
		#ifdef ENVMAP_BLENDING_MULTIPLY
			outgoingLight = mix( outgoingLight, outgoingLight * envColor.xyz, specularStrength * reflectivity );
		#elif defined( ENVMAP_BLENDING_MIX )
			outgoingLight = mix( outgoingLight, envColor.xyz, specularStrength * reflectivity );
		#elif defined( ENVMAP_BLENDING_ADD )
			outgoingLight += envColor.xyz * specularStrength * reflectivity;
		#endif
	#endif
#endif`,Sy=`#ifdef USE_ENVMAP
	uniform float envMapIntensity;
	uniform mat3 envMapRotation;
	uniform samplerCube envMap;
	#ifdef ENVMAP_TYPE_PMREM
		float roughnessToMip( const in float roughness ) {
			float r = clamp( roughness, 0.0, 1.0 );
			return ENVMAP_MAX_LOD * r * ( 2.0 - r );
		}
	#endif
#endif`,My=`#ifdef USE_ENVMAP
	uniform float reflectivity;
	#if defined( USE_BUMPMAP ) || defined( USE_NORMALMAP ) || defined( PHONG ) || defined( LAMBERT )
		#define ENV_WORLDPOS
	#endif
	#ifdef ENV_WORLDPOS
		varying vec3 vWorldPosition;
		uniform float refractionRatio;
	#else
		varying vec3 vReflect;
	#endif
#endif`,wy=`#ifdef USE_ENVMAP
	#if defined( USE_BUMPMAP ) || defined( USE_NORMALMAP ) || defined( PHONG ) || defined( LAMBERT )
		#define ENV_WORLDPOS
	#endif
	#ifdef ENV_WORLDPOS
		
		varying vec3 vWorldPosition;
	#else
		varying vec3 vReflect;
		uniform float refractionRatio;
	#endif
#endif`,Ay=`#ifdef USE_ENVMAP
	#ifdef ENV_WORLDPOS
		vWorldPosition = worldPosition.xyz;
	#else
		vec3 cameraToVertex;
		if ( isOrthographic ) {
			cameraToVertex = normalize( vec3( - viewMatrix[ 0 ][ 2 ], - viewMatrix[ 1 ][ 2 ], - viewMatrix[ 2 ][ 2 ] ) );
		} else {
			cameraToVertex = normalize( worldPosition.xyz - cameraPosition );
		}
		vec3 worldNormal = transformNormalByInverseViewMatrix( transformedNormal, viewMatrix );
		#ifdef ENVMAP_MODE_REFLECTION
			vReflect = reflect( cameraToVertex, worldNormal );
		#else
			vReflect = refract( cameraToVertex, worldNormal, refractionRatio );
		#endif
	#endif
#endif`,Ey=`#ifdef USE_FOG
	vFogDepth = - mvPosition.z;
#endif`,Ty=`#ifdef USE_FOG
	varying float vFogDepth;
#endif`,Ry=`#ifdef USE_FOG
	#ifdef FOG_EXP2
		float fogFactor = 1.0 - exp( - fogDensity * fogDensity * vFogDepth * vFogDepth );
	#else
		float fogFactor = smoothstep( fogNear, fogFar, vFogDepth );
	#endif
	gl_FragColor.rgb = mix( gl_FragColor.rgb, fogColor, fogFactor );
#endif`,Cy=`#ifdef USE_FOG
	uniform vec3 fogColor;
	varying float vFogDepth;
	#ifdef FOG_EXP2
		uniform float fogDensity;
	#else
		uniform float fogNear;
		uniform float fogFar;
	#endif
#endif`,Py=`#ifdef USE_GRADIENTMAP
	uniform sampler2D gradientMap;
#endif
vec3 getGradientIrradiance( vec3 normal, vec3 lightDirection ) {
	float dotNL = dot( normal, lightDirection );
	vec2 coord = vec2( dotNL * 0.5 + 0.5, 0.0 );
	#ifdef USE_GRADIENTMAP
		return vec3( texture2D( gradientMap, coord ).r );
	#else
		vec2 fw = fwidth( coord ) * 0.5;
		return mix( vec3( 0.7 ), vec3( 1.0 ), smoothstep( 0.7 - fw.x, 0.7 + fw.x, coord.x ) );
	#endif
}`,Iy=`#ifdef USE_LIGHTMAP
	uniform sampler2D lightMap;
	uniform float lightMapIntensity;
#endif`,Ly=`LambertMaterial material;
material.diffuseColor = diffuseColor.rgb;
material.specularStrength = specularStrength;`,Dy=`varying vec3 vViewPosition;
struct LambertMaterial {
	vec3 diffuseColor;
	float specularStrength;
};
void RE_Direct_Lambert( const in IncidentLight directLight, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in LambertMaterial material, inout ReflectedLight reflectedLight ) {
	float dotNL = saturate( dot( geometryNormal, directLight.direction ) );
	vec3 irradiance = dotNL * directLight.color;
	reflectedLight.directDiffuse += irradiance * BRDF_Lambert( material.diffuseColor );
}
void RE_IndirectDiffuse_Lambert( const in vec3 irradiance, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in LambertMaterial material, inout ReflectedLight reflectedLight ) {
	reflectedLight.indirectDiffuse += irradiance * BRDF_Lambert( material.diffuseColor );
}
#define RE_Direct				RE_Direct_Lambert
#define RE_IndirectDiffuse		RE_IndirectDiffuse_Lambert`,Ny=`uniform bool receiveShadow;
uniform vec3 ambientLightColor;
#if defined( USE_LIGHT_PROBES )
	uniform vec3 lightProbe[ 9 ];
#endif
vec3 shGetIrradianceAt( in vec3 normal, in vec3 shCoefficients[ 9 ] ) {
	float x = normal.x, y = normal.y, z = normal.z;
	vec3 result = shCoefficients[ 0 ] * 0.886227;
	result += shCoefficients[ 1 ] * 2.0 * 0.511664 * y;
	result += shCoefficients[ 2 ] * 2.0 * 0.511664 * z;
	result += shCoefficients[ 3 ] * 2.0 * 0.511664 * x;
	result += shCoefficients[ 4 ] * 2.0 * 0.429043 * x * y;
	result += shCoefficients[ 5 ] * 2.0 * 0.429043 * y * z;
	result += shCoefficients[ 6 ] * ( 0.743125 * z * z - 0.247708 );
	result += shCoefficients[ 7 ] * 2.0 * 0.429043 * x * z;
	result += shCoefficients[ 8 ] * 0.429043 * ( x * x - y * y );
	return result;
}
vec3 getLightProbeIrradiance( const in vec3 lightProbe[ 9 ], const in vec3 normal ) {
	vec3 worldNormal = transformNormalByInverseViewMatrix( normal, viewMatrix );
	vec3 irradiance = shGetIrradianceAt( worldNormal, lightProbe );
	return irradiance;
}
vec3 getAmbientLightIrradiance( const in vec3 ambientLightColor ) {
	vec3 irradiance = ambientLightColor;
	return irradiance;
}
float getDistanceAttenuation( const in float lightDistance, const in float cutoffDistance, const in float decayExponent ) {
	float distanceFalloff = 1.0 / max( pow( lightDistance, decayExponent ), 0.01 );
	if ( cutoffDistance > 0.0 ) {
		distanceFalloff *= pow2( saturate( 1.0 - pow4( lightDistance / cutoffDistance ) ) );
	}
	return distanceFalloff;
}
float getSpotAttenuation( const in float coneCosine, const in float penumbraCosine, const in float angleCosine ) {
	return smoothstep( coneCosine, penumbraCosine, angleCosine );
}
#if NUM_SUN_LIGHTS > 0
	struct SunLight {
		vec3 direction;
		vec3 color;
	};
	uniform SunLight sunLights[ NUM_SUN_LIGHTS ];
	void getSunLightInfo( const in SunLight sunLight, out IncidentLight light ) {
		light.color = sunLight.color;
		light.direction = sunLight.direction;
		light.visible = true;
	}
#endif
#if NUM_DIR_LIGHTS > 0
	struct DirectionalLight {
		vec3 direction;
		vec3 color;
	};
	uniform DirectionalLight directionalLights[ NUM_DIR_LIGHTS ];
	void getDirectionalLightInfo( const in DirectionalLight directionalLight, out IncidentLight light ) {
		light.color = directionalLight.color;
		light.direction = directionalLight.direction;
		light.visible = true;
	}
#endif
#if NUM_POINT_LIGHTS > 0
	struct PointLight {
		vec3 position;
		vec3 color;
		float distance;
		float decay;
	};
	uniform PointLight pointLights[ NUM_POINT_LIGHTS ];
	void getPointLightInfo( const in PointLight pointLight, const in vec3 geometryPosition, out IncidentLight light ) {
		vec3 lVector = pointLight.position - geometryPosition;
		light.direction = normalize( lVector );
		float lightDistance = length( lVector );
		light.color = pointLight.color;
		light.color *= getDistanceAttenuation( lightDistance, pointLight.distance, pointLight.decay );
		light.visible = ( light.color != vec3( 0.0 ) );
	}
#endif
#if NUM_SPOT_LIGHTS > 0
	struct SpotLight {
		vec3 position;
		vec3 direction;
		vec3 color;
		float distance;
		float decay;
		float coneCos;
		float penumbraCos;
	};
	uniform SpotLight spotLights[ NUM_SPOT_LIGHTS ];
	void getSpotLightInfo( const in SpotLight spotLight, const in vec3 geometryPosition, out IncidentLight light ) {
		vec3 lVector = spotLight.position - geometryPosition;
		light.direction = normalize( lVector );
		float angleCos = dot( light.direction, spotLight.direction );
		float spotAttenuation = getSpotAttenuation( spotLight.coneCos, spotLight.penumbraCos, angleCos );
		if ( spotAttenuation > 0.0 ) {
			float lightDistance = length( lVector );
			light.color = spotLight.color * spotAttenuation;
			light.color *= getDistanceAttenuation( lightDistance, spotLight.distance, spotLight.decay );
			light.visible = ( light.color != vec3( 0.0 ) );
		} else {
			light.color = vec3( 0.0 );
			light.visible = false;
		}
	}
#endif
#if NUM_RECT_AREA_LIGHTS > 0
	struct RectAreaLight {
		vec3 color;
		vec3 position;
		vec3 halfWidth;
		vec3 halfHeight;
	};
	uniform sampler2D ltc_1;	uniform sampler2D ltc_2;
	uniform RectAreaLight rectAreaLights[ NUM_RECT_AREA_LIGHTS ];
#endif
#if NUM_HEMI_LIGHTS > 0
	struct HemisphereLight {
		vec3 direction;
		vec3 skyColor;
		vec3 groundColor;
	};
	uniform HemisphereLight hemisphereLights[ NUM_HEMI_LIGHTS ];
	vec3 getHemisphereLightIrradiance( const in HemisphereLight hemiLight, const in vec3 normal ) {
		float dotNL = dot( normal, hemiLight.direction );
		float hemiDiffuseWeight = 0.5 * dotNL + 0.5;
		vec3 irradiance = mix( hemiLight.groundColor, hemiLight.skyColor, hemiDiffuseWeight );
		return irradiance;
	}
#endif
#include <lightprobes_pars_fragment>`,Fy=`#ifdef USE_ENVMAP
	vec3 getIBLIrradiance( const in vec3 normal ) {
		#ifdef ENVMAP_TYPE_PMREM
			vec3 worldNormal = transformNormalByInverseViewMatrix( normal, viewMatrix );
			vec4 envMapColor = textureLod( envMap, envMapRotation * worldNormal, ENVMAP_MAX_LOD );
			return PI * envMapColor.rgb * envMapIntensity;
		#else
			return vec3( 0.0 );
		#endif
	}
	vec3 getIBLRadiance( const in vec3 viewDir, const in vec3 normal, const in float roughness ) {
		#ifdef ENVMAP_TYPE_PMREM
			vec3 reflectVec = reflect( - viewDir, normal );
			reflectVec = normalize( mix( reflectVec, normal, pow4( roughness ) ) );
			reflectVec = transformDirectionByInverseViewMatrix( reflectVec, viewMatrix );
			vec4 envMapColor = textureLod( envMap, envMapRotation * reflectVec, roughnessToMip( roughness ) );
			return envMapColor.rgb * envMapIntensity;
		#else
			return vec3( 0.0 );
		#endif
	}
	#ifdef USE_RETROREFLECTION
		vec3 getIBLRetroRadiance( const in vec3 viewDir, const in vec3 normal, const in float roughness ) {
			#ifdef ENVMAP_TYPE_PMREM
				vec3 retroVec = normalize( mix( viewDir, normal, pow4( roughness ) ) );
				retroVec = transformDirectionByInverseViewMatrix( retroVec, viewMatrix );
				vec4 envMapColor = textureLod( envMap, envMapRotation * retroVec, roughnessToMip( roughness ) );
				return envMapColor.rgb * envMapIntensity;
			#else
				return vec3( 0.0 );
			#endif
		}
	#endif
	#ifdef USE_ANISOTROPY
		vec3 getIBLAnisotropyRadiance( const in vec3 viewDir, const in vec3 normal, const in float roughness, const in vec3 bitangent, const in float anisotropy ) {
			#ifdef ENVMAP_TYPE_PMREM
				vec3 bentNormal = cross( bitangent, viewDir );
				bentNormal = normalize( cross( bentNormal, bitangent ) );
				bentNormal = normalize( mix( bentNormal, normal, pow2( pow2( 1.0 - anisotropy * ( 1.0 - roughness ) ) ) ) );
				return getIBLRadiance( viewDir, bentNormal, roughness );
			#else
				return vec3( 0.0 );
			#endif
		}
		#ifdef USE_RETROREFLECTION
			vec3 getIBLAnisotropyRetroRadiance( const in vec3 viewDir, const in vec3 normal, const in float roughness, const in vec3 bitangent, const in float anisotropy ) {
				#ifdef ENVMAP_TYPE_PMREM
					vec3 bentNormal = cross( bitangent, viewDir );
					bentNormal = normalize( cross( bentNormal, bitangent ) );
					bentNormal = normalize( mix( bentNormal, normal, pow2( pow2( 1.0 - anisotropy * ( 1.0 - roughness ) ) ) ) );
					return getIBLRetroRadiance( viewDir, bentNormal, roughness );
				#else
					return vec3( 0.0 );
				#endif
			}
		#endif
	#endif
#endif`,Uy=`ToonMaterial material;
material.diffuseColor = diffuseColor.rgb;`,Oy=`varying vec3 vViewPosition;
struct ToonMaterial {
	vec3 diffuseColor;
};
void RE_Direct_Toon( const in IncidentLight directLight, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in ToonMaterial material, inout ReflectedLight reflectedLight ) {
	vec3 irradiance = getGradientIrradiance( geometryNormal, directLight.direction ) * directLight.color;
	reflectedLight.directDiffuse += irradiance * BRDF_Lambert( material.diffuseColor );
}
void RE_IndirectDiffuse_Toon( const in vec3 irradiance, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in ToonMaterial material, inout ReflectedLight reflectedLight ) {
	reflectedLight.indirectDiffuse += irradiance * BRDF_Lambert( material.diffuseColor );
}
#define RE_Direct				RE_Direct_Toon
#define RE_IndirectDiffuse		RE_IndirectDiffuse_Toon`,By=`BlinnPhongMaterial material;
material.diffuseColor = diffuseColor.rgb;
material.specularColor = specular;
material.specularShininess = shininess;
material.specularStrength = specularStrength;`,ky=`varying vec3 vViewPosition;
struct BlinnPhongMaterial {
	vec3 diffuseColor;
	vec3 specularColor;
	float specularShininess;
	float specularStrength;
};
void RE_Direct_BlinnPhong( const in IncidentLight directLight, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in BlinnPhongMaterial material, inout ReflectedLight reflectedLight ) {
	float dotNL = saturate( dot( geometryNormal, directLight.direction ) );
	vec3 irradiance = dotNL * directLight.color;
	reflectedLight.directDiffuse += irradiance * BRDF_Lambert( material.diffuseColor );
	reflectedLight.directSpecular += irradiance * BRDF_BlinnPhong( directLight.direction, geometryViewDir, geometryNormal, material.specularColor, material.specularShininess ) * material.specularStrength;
}
void RE_IndirectDiffuse_BlinnPhong( const in vec3 irradiance, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in BlinnPhongMaterial material, inout ReflectedLight reflectedLight ) {
	reflectedLight.indirectDiffuse += irradiance * BRDF_Lambert( material.diffuseColor );
}
#define RE_Direct				RE_Direct_BlinnPhong
#define RE_IndirectDiffuse		RE_IndirectDiffuse_BlinnPhong`,zy=`PhysicalMaterial material;
material.diffuseColor = diffuseColor.rgb;
material.diffuseContribution = diffuseColor.rgb * ( 1.0 - metalnessFactor );
material.metalness = metalnessFactor;
vec3 dxy = max( abs( dFdx( nonPerturbedNormal ) ), abs( dFdy( nonPerturbedNormal ) ) );
float geometryRoughness = max( max( dxy.x, dxy.y ), dxy.z );
material.roughness = max( roughnessFactor, 0.045 );
material.roughness += geometryRoughness;
material.roughness = min( material.roughness, 1.0 );
#ifdef USE_DIFFUSE_ROUGHNESS
	float diffuseRoughnessFactor = diffuseRoughness;
	#ifdef USE_DIFFUSE_ROUGHNESSMAP
		diffuseRoughnessFactor *= texture2D( diffuseRoughnessMap, vDiffuseRoughnessMapUv ).r;
	#endif
	material.diffuseRoughness = saturate( diffuseRoughnessFactor );
#endif
#ifdef IOR
	material.ior = ior;
	#ifdef USE_SPECULAR
		float specularIntensityFactor = specularIntensity;
		vec3 specularColorFactor = specularColor;
		#ifdef USE_SPECULAR_COLORMAP
			specularColorFactor *= texture2D( specularColorMap, vSpecularColorMapUv ).rgb;
		#endif
		#ifdef USE_SPECULAR_INTENSITYMAP
			specularIntensityFactor *= texture2D( specularIntensityMap, vSpecularIntensityMapUv ).a;
		#endif
		material.specularF90 = mix( specularIntensityFactor, 1.0, metalnessFactor );
	#else
		float specularIntensityFactor = 1.0;
		vec3 specularColorFactor = vec3( 1.0 );
		material.specularF90 = 1.0;
	#endif
	material.specularColor = min( pow2( ( material.ior - 1.0 ) / ( material.ior + 1.0 ) ) * specularColorFactor, vec3( 1.0 ) ) * specularIntensityFactor;
	material.specularColorBlended = mix( material.specularColor, diffuseColor.rgb, metalnessFactor );
#else
	material.specularColor = vec3( 0.04 );
	material.specularColorBlended = mix( material.specularColor, diffuseColor.rgb, metalnessFactor );
	material.specularF90 = 1.0;
#endif
#ifdef USE_CLEARCOAT
	material.clearcoat = clearcoat;
	material.clearcoatRoughness = clearcoatRoughness;
	material.clearcoatF0 = vec3( 0.04 );
	material.clearcoatF90 = 1.0;
	#ifdef USE_CLEARCOATMAP
		material.clearcoat *= texture2D( clearcoatMap, vClearcoatMapUv ).x;
	#endif
	#ifdef USE_CLEARCOAT_ROUGHNESSMAP
		material.clearcoatRoughness *= texture2D( clearcoatRoughnessMap, vClearcoatRoughnessMapUv ).y;
	#endif
	material.clearcoat = saturate( material.clearcoat );	material.clearcoatRoughness = max( material.clearcoatRoughness, 0.045 );
	material.clearcoatRoughness += geometryRoughness;
	material.clearcoatRoughness = min( material.clearcoatRoughness, 1.0 );
#endif
#ifdef USE_DISPERSION
	material.dispersion = dispersion;
#endif
#ifdef USE_RETROREFLECTION
	material.retroreflectivity = retroreflectivity;
#endif
#ifdef USE_IRIDESCENCE
	material.iridescence = iridescence;
	material.iridescenceIOR = iridescenceIOR;
	#ifdef USE_IRIDESCENCEMAP
		material.iridescence *= texture2D( iridescenceMap, vIridescenceMapUv ).r;
	#endif
	#ifdef USE_IRIDESCENCE_THICKNESSMAP
		material.iridescenceThickness = (iridescenceThicknessMaximum - iridescenceThicknessMinimum) * texture2D( iridescenceThicknessMap, vIridescenceThicknessMapUv ).g + iridescenceThicknessMinimum;
	#else
		material.iridescenceThickness = iridescenceThicknessMaximum;
	#endif
#endif
#ifdef USE_SHEEN
	material.sheenColor = sheenColor;
	#ifdef USE_SHEEN_COLORMAP
		material.sheenColor *= texture2D( sheenColorMap, vSheenColorMapUv ).rgb;
	#endif
	material.sheenRoughness = clamp( sheenRoughness, 0.0001, 1.0 );
	#ifdef USE_SHEEN_ROUGHNESSMAP
		material.sheenRoughness *= texture2D( sheenRoughnessMap, vSheenRoughnessMapUv ).a;
	#endif
#endif
#ifdef USE_ANISOTROPY
	#ifdef USE_ANISOTROPYMAP
		mat2 anisotropyMat = mat2( anisotropyVector.x, anisotropyVector.y, - anisotropyVector.y, anisotropyVector.x );
		vec3 anisotropyPolar = texture2D( anisotropyMap, vAnisotropyMapUv ).rgb;
		vec2 anisotropyV = anisotropyMat * normalize( 2.0 * anisotropyPolar.rg - vec2( 1.0 ) ) * anisotropyPolar.b;
	#else
		vec2 anisotropyV = anisotropyVector;
	#endif
	material.anisotropy = length( anisotropyV );
	if( material.anisotropy == 0.0 ) {
		anisotropyV = vec2( 1.0, 0.0 );
	} else {
		anisotropyV /= material.anisotropy;
		material.anisotropy = saturate( material.anisotropy );
	}
	material.alphaT = mix( pow2( material.roughness ), 1.0, pow2( material.anisotropy ) );
	material.anisotropyT = tbn[ 0 ] * anisotropyV.x + tbn[ 1 ] * anisotropyV.y;
	material.anisotropyB = tbn[ 1 ] * anisotropyV.x - tbn[ 0 ] * anisotropyV.y;
#endif`,Vy=`uniform sampler2D dfgLUT;
struct PhysicalMaterial {
	vec3 diffuseColor;
	vec3 diffuseContribution;
	vec3 specularColor;
	vec3 specularColorBlended;
	float roughness;
	float metalness;
	float specularF90;
	float dispersion;
	vec2 dfg;
	vec3 multiScatteringCompensation;
	#ifdef USE_DIFFUSE_ROUGHNESS
		float diffuseRoughness;
	#endif
	#ifdef USE_RETROREFLECTION
		float retroreflectivity;
	#endif
	#ifdef USE_CLEARCOAT
		float clearcoat;
		float clearcoatRoughness;
		vec3 clearcoatF0;
		float clearcoatF90;
	#endif
	#ifdef USE_IRIDESCENCE
		float iridescence;
		float iridescenceIOR;
		float iridescenceThickness;
		vec3 iridescenceFresnel;
		vec3 iridescenceF0Dielectric;
		vec3 iridescenceF0Metallic;
	#endif
	#ifdef USE_SHEEN
		vec3 sheenColor;
		float sheenRoughness;
	#endif
	#ifdef IOR
		float ior;
	#endif
	#ifdef USE_TRANSMISSION
		float transmission;
		float transmissionAlpha;
		float thickness;
		float attenuationDistance;
		vec3 attenuationColor;
	#endif
	#ifdef USE_ANISOTROPY
		float anisotropy;
		float alphaT;
		vec3 anisotropyT;
		vec3 anisotropyB;
	#endif
};
vec3 clearcoatSpecularDirect = vec3( 0.0 );
vec3 clearcoatSpecularIndirect = vec3( 0.0 );
vec3 sheenSpecularDirect = vec3( 0.0 );
vec3 sheenSpecularIndirect = vec3(0.0 );
vec3 Schlick_to_F0( const in vec3 f, const in float f90, const in float dotVH ) {
    float x = clamp( 1.0 - dotVH, 0.0, 1.0 );
    float x2 = x * x;
    float x5 = clamp( x * x2 * x2, 0.0, 0.9999 );
    return ( f - vec3( f90 ) * x5 ) / ( 1.0 - x5 );
}
#ifdef USE_DIFFUSE_ROUGHNESS
	const float EON_EPSILON = 1e-7;
	float FON_DirectionalAlbedo( const in float mu, const in float roughness, const in float A ) {
		float muComp = 1.0 - mu;
		float gOverPi = muComp * ( 0.0571085289 + muComp * ( 0.491881867 + muComp * ( - 0.332181442 + muComp * 0.0714429953 ) ) );
		return A * ( 1.0 + roughness * gOverPi );
	}
	vec3 BRDF_EON( const in vec3 lightDir, const in vec3 viewDir, const in vec3 normal, const in vec3 diffuseColor, const in float roughness ) {
		vec3 rho = saturate( diffuseColor );
		if ( roughness <= EON_EPSILON ) return BRDF_Lambert( rho );
		float dotNL = saturate( dot( normal, lightDir ) );
		float dotNV = saturate( dot( normal, viewDir ) );
		float s = dot( lightDir, viewDir ) - dotNL * dotNV;
		float sOverT = ( s > 0.0 ) ? s / max( max( dotNL, dotNV ), EON_EPSILON ) : s;
		float A = 1.0 / ( 1.0 + ( 0.5 - 2.0 / ( 3.0 * PI ) ) * roughness );
		vec3 singleScatter = rho * RECIPROCAL_PI * A * ( 1.0 + roughness * sOverT );
		float averageAlbedo = A * ( 1.0 + ( 2.0 / 3.0 - 28.0 / ( 15.0 * PI ) ) * roughness );
		float albedoV = FON_DirectionalAlbedo( dotNV, roughness, A );
		float albedoL = FON_DirectionalAlbedo( dotNL, roughness, A );
		vec3 rhoMultiScatter = rho * rho * averageAlbedo / max( vec3( EON_EPSILON ), vec3( 1.0 ) - rho * ( 1.0 - averageAlbedo ) );
		vec3 multiScatter = rhoMultiScatter * RECIPROCAL_PI
			* max( EON_EPSILON, 1.0 - albedoV )
			* max( EON_EPSILON, 1.0 - albedoL )
			/ max( EON_EPSILON, 1.0 - averageAlbedo );
		return singleScatter + multiScatter;
	}
	vec3 EON_DirectionalAlbedo( const in vec3 diffuseColor, const in float roughness, const in float dotNV ) {
		vec3 rho = saturate( diffuseColor );
		if ( roughness <= EON_EPSILON ) return rho;
		float A = 1.0 / ( 1.0 + ( 0.5 - 2.0 / ( 3.0 * PI ) ) * roughness );
		float directionalAlbedo = FON_DirectionalAlbedo( dotNV, roughness, A );
		float averageAlbedo = A * ( 1.0 + ( 2.0 / 3.0 - 28.0 / ( 15.0 * PI ) ) * roughness );
		vec3 rhoMultiScatter = rho * rho * averageAlbedo / max( vec3( EON_EPSILON ), vec3( 1.0 ) - rho * ( 1.0 - averageAlbedo ) );
		return rho * directionalAlbedo + rhoMultiScatter * ( 1.0 - directionalAlbedo );
	}
#endif
float V_GGX_SmithCorrelated( const in float alpha, const in float dotNL, const in float dotNV ) {
	float a2 = pow2( alpha );
	float gv = dotNL * sqrt( a2 + ( 1.0 - a2 ) * pow2( dotNV ) );
	float gl = dotNV * sqrt( a2 + ( 1.0 - a2 ) * pow2( dotNL ) );
	return 0.5 / max( gv + gl, EPSILON );
}
float D_GGX( const in float alpha, const in float dotNH ) {
	float a2 = pow2( alpha );
	float denom = pow2( dotNH ) * ( a2 - 1.0 ) + 1.0;
	return RECIPROCAL_PI * a2 / pow2( denom );
}
#ifdef USE_ANISOTROPY
	float V_GGX_SmithCorrelated_Anisotropic( const in float alphaT, const in float alphaB, const in float dotTV, const in float dotBV, const in float dotTL, const in float dotBL, const in float dotNV, const in float dotNL ) {
		float gv = dotNL * length( vec3( alphaT * dotTV, alphaB * dotBV, dotNV ) );
		float gl = dotNV * length( vec3( alphaT * dotTL, alphaB * dotBL, dotNL ) );
		return 0.5 / max( gv + gl, EPSILON );
	}
	float D_GGX_Anisotropic( const in float alphaT, const in float alphaB, const in float dotNH, const in float dotTH, const in float dotBH ) {
		float a2 = alphaT * alphaB;
		highp vec3 v = vec3( alphaB * dotTH, alphaT * dotBH, a2 * dotNH );
		highp float v2 = dot( v, v );
		float w2 = a2 / v2;
		return RECIPROCAL_PI * a2 * pow2 ( w2 );
	}
#endif
#ifdef USE_CLEARCOAT
	vec3 BRDF_GGX_Clearcoat( const in vec3 lightDir, const in vec3 viewDir, const in vec3 normal, const in PhysicalMaterial material) {
		vec3 f0 = material.clearcoatF0;
		float f90 = material.clearcoatF90;
		float roughness = max( material.clearcoatRoughness, 0.045 );
		float alpha = pow2( roughness );
		vec3 halfDir = normalize( lightDir + viewDir );
		float dotNL = saturate( dot( normal, lightDir ) );
		float dotNV = saturate( dot( normal, viewDir ) );
		float dotNH = saturate( dot( normal, halfDir ) );
		float dotVH = saturate( dot( viewDir, halfDir ) );
		vec3 F = F_Schlick( f0, f90, dotVH );
		float V = V_GGX_SmithCorrelated( alpha, dotNL, dotNV );
		float D = D_GGX( alpha, dotNH );
		return F * ( V * D );
	}
#endif
vec3 BRDF_GGX( const in vec3 lightDir, const in vec3 viewDir, const in vec3 normal, const in PhysicalMaterial material ) {
	vec3 f0 = material.specularColorBlended;
	float f90 = material.specularF90;
	float roughness = max( material.roughness, 0.045 );
	float alpha = pow2( roughness );
	vec3 halfDir = normalize( lightDir + viewDir );
	float dotNL = saturate( dot( normal, lightDir ) );
	float dotNV = saturate( dot( normal, viewDir ) );
	float dotNH = saturate( dot( normal, halfDir ) );
	float dotVH = saturate( dot( viewDir, halfDir ) );
	vec3 F = F_Schlick( f0, f90, dotVH );
	#ifdef USE_IRIDESCENCE
		F = mix( F, material.iridescenceFresnel, material.iridescence );
	#endif
	#ifdef USE_ANISOTROPY
		float dotTL = dot( material.anisotropyT, lightDir );
		float dotTV = dot( material.anisotropyT, viewDir );
		float dotTH = dot( material.anisotropyT, halfDir );
		float dotBL = dot( material.anisotropyB, lightDir );
		float dotBV = dot( material.anisotropyB, viewDir );
		float dotBH = dot( material.anisotropyB, halfDir );
		float alphaT = max( material.alphaT, alpha );
		float V = V_GGX_SmithCorrelated_Anisotropic( alphaT, alpha, dotTV, dotBV, dotTL, dotBL, dotNV, dotNL );
		float D = D_GGX_Anisotropic( alphaT, alpha, dotNH, dotTH, dotBH );
	#else
		float V = V_GGX_SmithCorrelated( alpha, dotNL, dotNV );
		float D = D_GGX( alpha, dotNH );
	#endif
	return F * ( V * D );
}
vec2 LTC_Uv( const in vec3 N, const in vec3 V, const in float roughness ) {
	const float LUT_SIZE = 64.0;
	const float LUT_SCALE = ( LUT_SIZE - 1.0 ) / LUT_SIZE;
	const float LUT_BIAS = 0.5 / LUT_SIZE;
	float dotNV = saturate( dot( N, V ) );
	vec2 uv = vec2( roughness, sqrt( 1.0 - dotNV ) );
	uv = uv * LUT_SCALE + LUT_BIAS;
	return uv;
}
float LTC_ClippedSphereFormFactor( const in vec3 f ) {
	float l = length( f );
	return max( ( l * l + f.z ) / ( l + 1.0 ), 0.0 );
}
vec3 LTC_EdgeVectorFormFactor( const in vec3 v1, const in vec3 v2 ) {
	float x = dot( v1, v2 );
	float y = abs( x );
	float a = 0.8543985 + ( 0.4965155 + 0.0145206 * y ) * y;
	float b = 3.4175940 + ( 4.1616724 + y ) * y;
	float v = a / b;
	float theta_sintheta = ( x > 0.0 ) ? v : 0.5 * inversesqrt( max( 1.0 - x * x, 1e-7 ) ) - v;
	return cross( v1, v2 ) * theta_sintheta;
}
vec3 LTC_Evaluate( const in vec3 N, const in vec3 V, const in vec3 P, const in mat3 mInv, const in vec3 rectCoords[ 4 ] ) {
	vec3 v1 = rectCoords[ 1 ] - rectCoords[ 0 ];
	vec3 v2 = rectCoords[ 3 ] - rectCoords[ 0 ];
	vec3 lightNormal = cross( v1, v2 );
	if( dot( lightNormal, P - rectCoords[ 0 ] ) < 0.0 ) return vec3( 0.0 );
	vec3 T1, T2;
	T1 = normalize( V - N * dot( V, N ) );
	T2 = - cross( N, T1 );
	mat3 mat = mInv * transpose( mat3( T1, T2, N ) );
	vec3 coords[ 4 ];
	coords[ 0 ] = mat * ( rectCoords[ 0 ] - P );
	coords[ 1 ] = mat * ( rectCoords[ 1 ] - P );
	coords[ 2 ] = mat * ( rectCoords[ 2 ] - P );
	coords[ 3 ] = mat * ( rectCoords[ 3 ] - P );
	coords[ 0 ] = normalize( coords[ 0 ] );
	coords[ 1 ] = normalize( coords[ 1 ] );
	coords[ 2 ] = normalize( coords[ 2 ] );
	coords[ 3 ] = normalize( coords[ 3 ] );
	vec3 vectorFormFactor = vec3( 0.0 );
	vectorFormFactor += LTC_EdgeVectorFormFactor( coords[ 0 ], coords[ 1 ] );
	vectorFormFactor += LTC_EdgeVectorFormFactor( coords[ 1 ], coords[ 2 ] );
	vectorFormFactor += LTC_EdgeVectorFormFactor( coords[ 2 ], coords[ 3 ] );
	vectorFormFactor += LTC_EdgeVectorFormFactor( coords[ 3 ], coords[ 0 ] );
	float result = LTC_ClippedSphereFormFactor( vectorFormFactor );
	return vec3( result );
}
#if defined( USE_SHEEN )
float D_Charlie( float roughness, float dotNH ) {
	float alpha = pow2( roughness );
	float invAlpha = 1.0 / alpha;
	float cos2h = dotNH * dotNH;
	float sin2h = max( 1.0 - cos2h, 0.0078125 );
	return ( 2.0 + invAlpha ) * pow( sin2h, invAlpha * 0.5 ) / ( 2.0 * PI );
}
float V_Neubelt( float dotNV, float dotNL ) {
	return saturate( 1.0 / ( 4.0 * ( dotNL + dotNV - dotNL * dotNV ) ) );
}
vec3 BRDF_Sheen( const in vec3 lightDir, const in vec3 viewDir, const in vec3 normal, vec3 sheenColor, const in float sheenRoughness ) {
	vec3 halfDir = normalize( lightDir + viewDir );
	float dotNL = saturate( dot( normal, lightDir ) );
	float dotNV = saturate( dot( normal, viewDir ) );
	float dotNH = saturate( dot( normal, halfDir ) );
	float D = D_Charlie( sheenRoughness, dotNH );
	float V = V_Neubelt( dotNV, dotNL );
	return sheenColor * ( D * V );
}
#endif
float IBLSheenBRDF( const in vec3 normal, const in vec3 viewDir, const in float roughness ) {
	float dotNV = saturate( dot( normal, viewDir ) );
	float r2 = roughness * roughness;
	float rInv = 1.0 / ( roughness + 0.1 );
	float a = -1.9362 + 1.0678 * roughness + 0.4573 * r2 - 0.8469 * rInv;
	float b = -0.6014 + 0.5538 * roughness - 0.4670 * r2 - 0.1255 * rInv;
	float DG = exp( a * dotNV + b );
	return saturate( DG );
}
vec3 EnvironmentBRDF( const in vec3 normal, const in vec3 viewDir, const in vec3 specularColor, const in float specularF90, const in float roughness ) {
	float dotNV = saturate( dot( normal, viewDir ) );
	vec2 fab = texture2D( dfgLUT, vec2( roughness, dotNV ) ).rg;
	return specularColor * fab.x + specularF90 * fab.y;
}
#ifdef USE_IRIDESCENCE
void computeMultiscatteringIridescence( const in vec2 fab, const in vec3 specularColor, const in float specularF90, const in float iridescence, const in vec3 iridescenceF0, inout vec3 singleScatter, inout vec3 multiScatter ) {
#else
void computeMultiscattering( const in vec2 fab, const in vec3 specularColor, const in float specularF90, inout vec3 singleScatter, inout vec3 multiScatter ) {
#endif
	#ifdef USE_IRIDESCENCE
		vec3 Fr = mix( specularColor, iridescenceF0, iridescence );
	#else
		vec3 Fr = specularColor;
	#endif
	vec3 FssEss = Fr * fab.x + specularF90 * fab.y;
	float Ess = fab.x + fab.y;
	float Ems = 1.0 - Ess;
	vec3 Favg = Fr + ( 1.0 - Fr ) * 0.047619;	vec3 Fms = FssEss * Favg / ( 1.0 - Ems * Favg );
	singleScatter += FssEss;
	multiScatter += Fms * Ems;
}
#if NUM_RECT_AREA_LIGHTS > 0
	void RE_Direct_RectArea_Physical( const in RectAreaLight rectAreaLight, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in PhysicalMaterial material, inout ReflectedLight reflectedLight ) {
		vec3 normal = geometryNormal;
		vec3 viewDir = geometryViewDir;
		vec3 position = geometryPosition;
		vec3 lightPos = rectAreaLight.position;
		vec3 halfWidth = rectAreaLight.halfWidth;
		vec3 halfHeight = rectAreaLight.halfHeight;
		vec3 lightColor = rectAreaLight.color;
		float roughness = material.roughness;
		vec3 rectCoords[ 4 ];
		rectCoords[ 0 ] = lightPos + halfWidth - halfHeight;		rectCoords[ 1 ] = lightPos - halfWidth - halfHeight;
		rectCoords[ 2 ] = lightPos - halfWidth + halfHeight;
		rectCoords[ 3 ] = lightPos + halfWidth + halfHeight;
		vec2 uv = LTC_Uv( normal, viewDir, roughness );
		vec4 t1 = texture2D( ltc_1, uv );
		vec4 t2 = texture2D( ltc_2, uv );
		mat3 mInv = mat3(
			vec3( t1.x, 0, t1.y ),
			vec3(    0, 1,    0 ),
			vec3( t1.z, 0, t1.w )
		);
		vec3 fresnel = ( material.specularColorBlended * t2.x + ( material.specularF90 - material.specularColorBlended ) * t2.y );
		reflectedLight.directSpecular += lightColor * fresnel * LTC_Evaluate( normal, viewDir, position, mInv, rectCoords );
		reflectedLight.directDiffuse += lightColor * material.diffuseContribution * LTC_Evaluate( normal, viewDir, position, mat3( 1.0 ), rectCoords );
		#ifdef USE_CLEARCOAT
			vec3 Ncc = geometryClearcoatNormal;
			vec2 uvClearcoat = LTC_Uv( Ncc, viewDir, material.clearcoatRoughness );
			vec4 t1Clearcoat = texture2D( ltc_1, uvClearcoat );
			vec4 t2Clearcoat = texture2D( ltc_2, uvClearcoat );
			mat3 mInvClearcoat = mat3(
				vec3( t1Clearcoat.x, 0, t1Clearcoat.y ),
				vec3(             0, 1,             0 ),
				vec3( t1Clearcoat.z, 0, t1Clearcoat.w )
			);
			vec3 fresnelClearcoat = material.clearcoatF0 * t2Clearcoat.x + ( material.clearcoatF90 - material.clearcoatF0 ) * t2Clearcoat.y;
			clearcoatSpecularDirect += lightColor * fresnelClearcoat * LTC_Evaluate( Ncc, viewDir, position, mInvClearcoat, rectCoords );
		#endif
	}
#endif
void RE_Direct_Physical( const in IncidentLight directLight, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in PhysicalMaterial material, inout ReflectedLight reflectedLight ) {
	float dotNL = saturate( dot( geometryNormal, directLight.direction ) );
	vec3 irradiance = dotNL * directLight.color;
	#ifdef USE_CLEARCOAT
		float dotNLcc = saturate( dot( geometryClearcoatNormal, directLight.direction ) );
		vec3 ccIrradiance = dotNLcc * directLight.color;
		clearcoatSpecularDirect += ccIrradiance * BRDF_GGX_Clearcoat( directLight.direction, geometryViewDir, geometryClearcoatNormal, material );
	#endif
	#ifdef USE_SHEEN
 
 		sheenSpecularDirect += irradiance * BRDF_Sheen( directLight.direction, geometryViewDir, geometryNormal, material.sheenColor, material.sheenRoughness );
 
 		float sheenAlbedoV = IBLSheenBRDF( geometryNormal, geometryViewDir, material.sheenRoughness );
 		float sheenAlbedoL = IBLSheenBRDF( geometryNormal, directLight.direction, material.sheenRoughness );
 
 		float sheenEnergyComp = 1.0 - max3( material.sheenColor ) * max( sheenAlbedoV, sheenAlbedoL );
 
 		irradiance *= sheenEnergyComp;
 
 	#endif
	vec3 specularBRDF = BRDF_GGX( directLight.direction, geometryViewDir, geometryNormal, material );
	#ifdef USE_RETROREFLECTION
		vec3 retroViewDir = reflect( - geometryViewDir, geometryNormal );
		vec3 retroSpecularBRDF = BRDF_GGX( directLight.direction, retroViewDir, geometryNormal, material );
		specularBRDF = mix( specularBRDF, retroSpecularBRDF, saturate( material.retroreflectivity ) );
	#endif
	reflectedLight.directSpecular += irradiance * specularBRDF * material.multiScatteringCompensation;
	vec3 halfDir = normalize( directLight.direction + geometryViewDir );
	float dotVH = saturate( dot( geometryViewDir, halfDir ) );
	vec3 F = F_Schlick( material.specularColor, material.specularF90, dotVH );
	#ifdef USE_RETROREFLECTION
		vec3 retroHalfDir = normalize( directLight.direction + retroViewDir );
		float dotRetroVH = saturate( dot( retroViewDir, retroHalfDir ) );
		vec3 retroF = F_Schlick( material.specularColor, material.specularF90, dotRetroVH );
		F = mix( F, retroF, saturate( material.retroreflectivity ) );
	#endif
	#ifdef USE_DIFFUSE_ROUGHNESS
		vec3 diffuseBRDF = BRDF_EON( directLight.direction, geometryViewDir, geometryNormal, material.diffuseColor, material.diffuseRoughness ) * ( 1.0 - material.metalness );
	#else
		vec3 diffuseBRDF = BRDF_Lambert( material.diffuseContribution );
	#endif
	reflectedLight.directDiffuse += irradiance * diffuseBRDF * ( 1.0 - F );
}
void RE_IndirectDiffuse_Physical( const in vec3 irradiance, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in PhysicalMaterial material, inout ReflectedLight reflectedLight ) {
	vec3 singleScattering = vec3( 0.0 );
	vec3 multiScattering = vec3( 0.0 );
	#ifdef USE_IRIDESCENCE
		computeMultiscatteringIridescence( material.dfg, material.specularColor, material.specularF90, material.iridescence, material.iridescenceF0Dielectric, singleScattering, multiScattering );
	#else
		computeMultiscattering( material.dfg, material.specularColor, material.specularF90, singleScattering, multiScattering );
	#endif
	#ifdef USE_DIFFUSE_ROUGHNESS
		float dotNV = saturate( dot( geometryNormal, geometryViewDir ) );
		vec3 diffuseAlbedo = EON_DirectionalAlbedo( material.diffuseColor, material.diffuseRoughness, dotNV ) * ( 1.0 - material.metalness );
		vec3 diffuse = irradiance * RECIPROCAL_PI * diffuseAlbedo * ( 1.0 - singleScattering - multiScattering );
	#else
		vec3 diffuse = irradiance * BRDF_Lambert( material.diffuseContribution ) * ( 1.0 - singleScattering - multiScattering );
	#endif
	#ifdef USE_SHEEN
		float sheenAlbedo = IBLSheenBRDF( geometryNormal, geometryViewDir, material.sheenRoughness );
		sheenSpecularIndirect += irradiance * material.sheenColor * sheenAlbedo * RECIPROCAL_PI;
		float sheenEnergyComp = 1.0 - max3( material.sheenColor ) * sheenAlbedo;
		diffuse *= sheenEnergyComp;
	#endif
	reflectedLight.indirectDiffuse += diffuse;
}
void RE_IndirectSpecular_Physical( const in vec3 radiance, const in vec3 irradiance, const in vec3 clearcoatRadiance, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in PhysicalMaterial material, inout ReflectedLight reflectedLight) {
	#ifdef USE_CLEARCOAT
		clearcoatSpecularIndirect += clearcoatRadiance * EnvironmentBRDF( geometryClearcoatNormal, geometryViewDir, material.clearcoatF0, material.clearcoatF90, material.clearcoatRoughness );
	#endif
	#ifdef USE_SHEEN
		sheenSpecularIndirect += irradiance * material.sheenColor * IBLSheenBRDF( geometryNormal, geometryViewDir, material.sheenRoughness ) * RECIPROCAL_PI;
 	#endif
	vec3 singleScatteringDielectric = vec3( 0.0 );
	vec3 multiScatteringDielectric = vec3( 0.0 );
	vec3 singleScatteringMetallic = vec3( 0.0 );
	vec3 multiScatteringMetallic = vec3( 0.0 );
	#ifdef USE_IRIDESCENCE
		computeMultiscatteringIridescence( material.dfg, material.specularColor, material.specularF90, material.iridescence, material.iridescenceF0Dielectric, singleScatteringDielectric, multiScatteringDielectric );
		computeMultiscatteringIridescence( material.dfg, material.diffuseColor, material.specularF90, material.iridescence, material.iridescenceF0Metallic, singleScatteringMetallic, multiScatteringMetallic );
	#else
		computeMultiscattering( material.dfg, material.specularColor, material.specularF90, singleScatteringDielectric, multiScatteringDielectric );
		computeMultiscattering( material.dfg, material.diffuseColor, material.specularF90, singleScatteringMetallic, multiScatteringMetallic );
	#endif
	vec3 singleScattering = mix( singleScatteringDielectric, singleScatteringMetallic, material.metalness );
	vec3 multiScattering = mix( multiScatteringDielectric, multiScatteringMetallic, material.metalness );
	vec3 totalScatteringDielectric = singleScatteringDielectric + multiScatteringDielectric;
	#ifdef USE_DIFFUSE_ROUGHNESS
		float dotNV = saturate( dot( geometryNormal, geometryViewDir ) );
		vec3 diffuse = EON_DirectionalAlbedo( material.diffuseColor, material.diffuseRoughness, dotNV ) * ( 1.0 - material.metalness ) * ( 1.0 - totalScatteringDielectric );
	#else
		vec3 diffuse = material.diffuseContribution * ( 1.0 - totalScatteringDielectric );
	#endif
	vec3 cosineWeightedIrradiance = irradiance * RECIPROCAL_PI;
	vec3 indirectSpecular = radiance * singleScattering;
	indirectSpecular += multiScattering * cosineWeightedIrradiance;
	vec3 indirectDiffuse = diffuse * cosineWeightedIrradiance;
	#ifdef USE_SHEEN
		float sheenAlbedo = IBLSheenBRDF( geometryNormal, geometryViewDir, material.sheenRoughness );
		float sheenEnergyComp = 1.0 - max3( material.sheenColor ) * sheenAlbedo;
		indirectSpecular *= sheenEnergyComp;
		indirectDiffuse *= sheenEnergyComp;
	#endif
	reflectedLight.indirectSpecular += indirectSpecular;
	reflectedLight.indirectDiffuse += indirectDiffuse;
}
#define RE_Direct				RE_Direct_Physical
#define RE_Direct_RectArea		RE_Direct_RectArea_Physical
#define RE_IndirectDiffuse		RE_IndirectDiffuse_Physical
#define RE_IndirectSpecular		RE_IndirectSpecular_Physical
float computeSpecularOcclusion( const in float dotNV, const in float ambientOcclusion, const in float roughness ) {
	return saturate( pow( dotNV + ambientOcclusion, exp2( - 16.0 * roughness - 1.0 ) ) - 1.0 + ambientOcclusion );
}`,Gy=`
vec3 geometryPosition = - vViewPosition;
vec3 geometryNormal = normal;
vec3 geometryViewDir = ( isOrthographic ) ? vec3( 0, 0, 1 ) : normalize( vViewPosition );
vec3 geometryClearcoatNormal = vec3( 0.0 );
#ifdef USE_CLEARCOAT
	geometryClearcoatNormal = clearcoatNormal;
#endif
#ifdef USE_IRIDESCENCE
	float dotNVi = saturate( dot( normal, geometryViewDir ) );
	if ( material.iridescenceThickness == 0.0 ) {
		material.iridescence = 0.0;
	} else {
		material.iridescence = saturate( material.iridescence );
	}
	if ( material.iridescence > 0.0 ) {
		vec3 iridescenceFresnelDielectric = evalIridescence( 1.0, material.iridescenceIOR, dotNVi, material.iridescenceThickness, material.specularColor );
		vec3 iridescenceFresnelMetallic = evalIridescence( 1.0, material.iridescenceIOR, dotNVi, material.iridescenceThickness, material.diffuseColor );
		material.iridescenceFresnel = mix( iridescenceFresnelDielectric, iridescenceFresnelMetallic, material.metalness );
		material.iridescenceF0Dielectric = Schlick_to_F0( iridescenceFresnelDielectric, 1.0, dotNVi );
		material.iridescenceF0Metallic = Schlick_to_F0( iridescenceFresnelMetallic, 1.0, dotNVi );
	}
#endif
#ifdef STANDARD
	float dotNVms = saturate( dot( geometryNormal, geometryViewDir ) );
	material.dfg = texture2D( dfgLUT, vec2( material.roughness, dotNVms ) ).rg;
	#if ( NUM_SUN_LIGHTS > 0 || NUM_DIR_LIGHTS > 0 || NUM_POINT_LIGHTS > 0 || NUM_SPOT_LIGHTS > 0 )
		float EssMs = material.dfg.x + material.dfg.y;
		material.multiScatteringCompensation = 1.0 + material.specularColorBlended * ( 1.0 / EssMs - 1.0 );
	#endif
#endif
IncidentLight directLight;
#if ( NUM_POINT_LIGHTS > 0 ) && defined( RE_Direct )
	PointLight pointLight;
	#if defined( USE_SHADOWMAP ) && NUM_POINT_LIGHT_SHADOWS > 0
	PointLightShadow pointLightShadow;
	#endif
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_POINT_LIGHTS; i ++ ) {
		pointLight = pointLights[ i ];
		getPointLightInfo( pointLight, geometryPosition, directLight );
		#if defined( USE_SHADOWMAP ) && ( UNROLLED_LOOP_INDEX < NUM_POINT_LIGHT_SHADOWS ) && ( defined( SHADOWMAP_TYPE_PCF ) || defined( SHADOWMAP_TYPE_BASIC ) )
		pointLightShadow = pointLightShadows[ i ];
		directLight.color *= ( directLight.visible && receiveShadow ) ? getPointShadow( pointShadowMap[ i ], pointLightShadow.shadowMapSize, pointLightShadow.shadowIntensity, pointLightShadow.shadowBias, pointLightShadow.shadowRadius, vPointShadowCoord[ i ], pointLightShadow.shadowCameraNear, pointLightShadow.shadowCameraFar ) : 1.0;
		#endif
		RE_Direct( directLight, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
	}
	#pragma unroll_loop_end
#endif
#if ( NUM_SPOT_LIGHTS > 0 ) && defined( RE_Direct )
	SpotLight spotLight;
	vec4 spotColor;
	vec3 spotLightCoord;
	bool inSpotLightMap;
	#if defined( USE_SHADOWMAP ) && NUM_SPOT_LIGHT_SHADOWS > 0
	SpotLightShadow spotLightShadow;
	#endif
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_SPOT_LIGHTS; i ++ ) {
		spotLight = spotLights[ i ];
		getSpotLightInfo( spotLight, geometryPosition, directLight );
		#if ( UNROLLED_LOOP_INDEX < NUM_SPOT_LIGHT_SHADOWS_WITH_MAPS )
		#define SPOT_LIGHT_MAP_INDEX UNROLLED_LOOP_INDEX
		#elif ( UNROLLED_LOOP_INDEX < NUM_SPOT_LIGHT_SHADOWS )
		#define SPOT_LIGHT_MAP_INDEX NUM_SPOT_LIGHT_MAPS
		#else
		#define SPOT_LIGHT_MAP_INDEX ( UNROLLED_LOOP_INDEX - NUM_SPOT_LIGHT_SHADOWS + NUM_SPOT_LIGHT_SHADOWS_WITH_MAPS )
		#endif
		#if ( SPOT_LIGHT_MAP_INDEX < NUM_SPOT_LIGHT_MAPS )
			spotLightCoord = vSpotLightCoord[ i ].xyz / vSpotLightCoord[ i ].w;
			inSpotLightMap = all( lessThan( abs( spotLightCoord * 2. - 1. ), vec3( 1.0 ) ) );
			spotColor = texture2D( spotLightMap[ SPOT_LIGHT_MAP_INDEX ], spotLightCoord.xy );
			directLight.color = inSpotLightMap ? directLight.color * spotColor.rgb : directLight.color;
		#endif
		#undef SPOT_LIGHT_MAP_INDEX
		#if defined( USE_SHADOWMAP ) && ( UNROLLED_LOOP_INDEX < NUM_SPOT_LIGHT_SHADOWS )
		spotLightShadow = spotLightShadows[ i ];
		directLight.color *= ( directLight.visible && receiveShadow ) ? getShadow( spotShadowMap[ i ], spotLightShadow.shadowMapSize, spotLightShadow.shadowIntensity, spotLightShadow.shadowBias, spotLightShadow.shadowRadius, vSpotLightCoord[ i ] ) : 1.0;
		#endif
		RE_Direct( directLight, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
	}
	#pragma unroll_loop_end
#endif
#if ( NUM_SUN_LIGHTS > 0 ) && defined( RE_Direct )
	SunLight sunLight;
	#if defined( USE_SHADOWMAP ) && NUM_SUN_LIGHT_SHADOWS > 0
	SunLightShadow sunLightShadow;
	#endif
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_SUN_LIGHTS; i ++ ) {
		sunLight = sunLights[ i ];
		getSunLightInfo( sunLight, directLight );
		#if defined( USE_SHADOWMAP ) && ( UNROLLED_LOOP_INDEX < NUM_SUN_LIGHT_SHADOWS )
		sunLightShadow = sunLightShadows[ i ];
		directLight.color *= ( directLight.visible && receiveShadow ) ? getSunShadow( sunShadowMap[ i ], sunLightShadow, UNROLLED_LOOP_INDEX ) : 1.0;
		#endif
		RE_Direct( directLight, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
	}
	#pragma unroll_loop_end
#endif
#if ( NUM_DIR_LIGHTS > 0 ) && defined( RE_Direct )
	DirectionalLight directionalLight;
	#if defined( USE_SHADOWMAP ) && NUM_DIR_LIGHT_SHADOWS > 0
	DirectionalLightShadow directionalLightShadow;
	#endif
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_DIR_LIGHTS; i ++ ) {
		directionalLight = directionalLights[ i ];
		getDirectionalLightInfo( directionalLight, directLight );
		#if defined( USE_SHADOWMAP ) && ( UNROLLED_LOOP_INDEX < NUM_DIR_LIGHT_SHADOWS )
		directionalLightShadow = directionalLightShadows[ i ];
		directLight.color *= ( directLight.visible && receiveShadow ) ? getShadow( directionalShadowMap[ i ], directionalLightShadow.shadowMapSize, directionalLightShadow.shadowIntensity, directionalLightShadow.shadowBias, directionalLightShadow.shadowRadius, vDirectionalShadowCoord[ i ] ) : 1.0;
		#endif
		RE_Direct( directLight, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
	}
	#pragma unroll_loop_end
#endif
#if ( NUM_RECT_AREA_LIGHTS > 0 ) && defined( RE_Direct_RectArea )
	RectAreaLight rectAreaLight;
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_RECT_AREA_LIGHTS; i ++ ) {
		rectAreaLight = rectAreaLights[ i ];
		RE_Direct_RectArea( rectAreaLight, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
	}
	#pragma unroll_loop_end
#endif
#if defined( RE_IndirectDiffuse )
	vec3 iblIrradiance = vec3( 0.0 );
	vec3 irradiance = getAmbientLightIrradiance( ambientLightColor );
	#if defined( USE_LIGHT_PROBES )
		irradiance += getLightProbeIrradiance( lightProbe, geometryNormal );
	#endif
	#if ( NUM_HEMI_LIGHTS > 0 )
		#pragma unroll_loop_start
		for ( int i = 0; i < NUM_HEMI_LIGHTS; i ++ ) {
			irradiance += getHemisphereLightIrradiance( hemisphereLights[ i ], geometryNormal );
		}
		#pragma unroll_loop_end
	#endif
	#if NUM_LIGHT_PROBE_GRIDS > 0
		vec3 probeWorldPos = ( ( vec4( geometryPosition, 1.0 ) - viewMatrix[ 3 ] ) * viewMatrix ).xyz;
		vec3 probeWorldNormal = transformNormalByInverseViewMatrix( geometryNormal, viewMatrix );
		int probeGrid = - 1;
		#pragma unroll_loop_start
		for ( int i = 0; i < NUM_LIGHT_PROBE_GRIDS; i ++ ) {
			if ( isInsideLightProbeGrid( probeWorldPos, probeWorldNormal, probesMin[ i ], probesMax[ i ], probesResolution[ i ] ) ) probeGrid = UNROLLED_LOOP_INDEX;
		}
		#pragma unroll_loop_end
		#pragma unroll_loop_start
		for ( int i = 0; i < NUM_LIGHT_PROBE_GRIDS; i ++ ) {
			if ( probeGrid == UNROLLED_LOOP_INDEX ) irradiance += getLightProbeGridIrradiance( probesSH[ i ], probesMin[ i ], probesMax[ i ], probesResolution[ i ], probeWorldPos, probeWorldNormal );
		}
		#pragma unroll_loop_end
	#endif
#endif
#if defined( RE_IndirectSpecular )
	vec3 radiance = vec3( 0.0 );
	vec3 clearcoatRadiance = vec3( 0.0 );
#endif`,Hy=`#if defined( RE_IndirectDiffuse )
	#ifdef USE_LIGHTMAP
		vec4 lightMapTexel = texture2D( lightMap, vLightMapUv );
		vec3 lightMapIrradiance = lightMapTexel.rgb * lightMapIntensity;
		irradiance += lightMapIrradiance;
	#endif
	#if defined( USE_ENVMAP ) && defined( ENVMAP_TYPE_PMREM )
		#if defined( STANDARD ) || defined( LAMBERT ) || defined( PHONG )
			iblIrradiance += getIBLIrradiance( geometryNormal );
		#endif
	#endif
#endif
#if defined( USE_ENVMAP ) && defined( RE_IndirectSpecular )
	#ifdef USE_ANISOTROPY
		vec3 iblRadiance = getIBLAnisotropyRadiance( geometryViewDir, geometryNormal, material.roughness, material.anisotropyB, material.anisotropy );
	#else
		vec3 iblRadiance = getIBLRadiance( geometryViewDir, geometryNormal, material.roughness );
	#endif
	#ifdef USE_RETROREFLECTION
		#ifdef USE_ANISOTROPY
			vec3 retroIBLRadiance = getIBLAnisotropyRetroRadiance( geometryViewDir, geometryNormal, material.roughness, material.anisotropyB, material.anisotropy );
		#else
			vec3 retroIBLRadiance = getIBLRetroRadiance( geometryViewDir, geometryNormal, material.roughness );
		#endif
		iblRadiance = mix( iblRadiance, retroIBLRadiance, saturate( material.retroreflectivity ) );
	#endif
	radiance += iblRadiance;
	#ifdef USE_CLEARCOAT
		clearcoatRadiance += getIBLRadiance( geometryViewDir, geometryClearcoatNormal, material.clearcoatRoughness );
	#endif
#endif`,Wy=`#if defined( RE_IndirectDiffuse )
	#if defined( LAMBERT ) || defined( PHONG )
		irradiance += iblIrradiance;
	#endif
	RE_IndirectDiffuse( irradiance, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
#endif
#if defined( RE_IndirectSpecular )
	RE_IndirectSpecular( radiance, iblIrradiance, clearcoatRadiance, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
#endif`,$y=`#if NUM_LIGHT_PROBE_GRIDS > 0
uniform highp sampler3D probesSH[ NUM_LIGHT_PROBE_GRIDS ];
uniform vec3 probesMin[ NUM_LIGHT_PROBE_GRIDS ];
uniform vec3 probesMax[ NUM_LIGHT_PROBE_GRIDS ];
uniform vec3 probesResolution[ NUM_LIGHT_PROBE_GRIDS ];
bool isInsideLightProbeGrid( vec3 worldPos, vec3 worldNormal, vec3 probesMin, vec3 probesMax, vec3 probesResolution ) {
	vec3 spacing = ( probesMax - probesMin ) / probesResolution;
	vec3 samplePos = worldPos + worldNormal * spacing * 0.5;
	vec3 margin = spacing * 0.01;
	return all( greaterThanEqual( samplePos, probesMin - margin ) ) && all( lessThanEqual( samplePos, probesMax + margin ) );
}
vec3 getLightProbeGridIrradiance( highp sampler3D probesSH, vec3 probesMin, vec3 probesMax, vec3 probesResolution, vec3 worldPos, vec3 worldNormal ) {
	vec3 res = probesResolution;
	vec3 gridRange = probesMax - probesMin;
	vec3 probeSpacing = gridRange / res;
	vec3 samplePos = worldPos + worldNormal * probeSpacing * 0.5;
	vec3 uvw = clamp( ( samplePos - probesMin ) / gridRange, 0.5 / res, 1.0 - 0.5 / res );
	float nz          = res.z;
	float paddedSlices = nz + 2.0;
	float atlasDepth  = 7.0 * paddedSlices;
	float uvZBase     = uvw.z * nz + 1.0;
	vec4 s0 = texture( probesSH, vec3( uvw.xy, ( uvZBase                       ) / atlasDepth ) );
	vec4 s1 = texture( probesSH, vec3( uvw.xy, ( uvZBase +       paddedSlices   ) / atlasDepth ) );
	vec4 s2 = texture( probesSH, vec3( uvw.xy, ( uvZBase + 2.0 * paddedSlices   ) / atlasDepth ) );
	vec4 s3 = texture( probesSH, vec3( uvw.xy, ( uvZBase + 3.0 * paddedSlices   ) / atlasDepth ) );
	vec4 s4 = texture( probesSH, vec3( uvw.xy, ( uvZBase + 4.0 * paddedSlices   ) / atlasDepth ) );
	vec4 s5 = texture( probesSH, vec3( uvw.xy, ( uvZBase + 5.0 * paddedSlices   ) / atlasDepth ) );
	vec4 s6 = texture( probesSH, vec3( uvw.xy, ( uvZBase + 6.0 * paddedSlices   ) / atlasDepth ) );
	vec3 c0 = s0.xyz;
	vec3 c1 = vec3( s0.w, s1.xy );
	vec3 c2 = vec3( s1.zw, s2.x );
	vec3 c3 = s2.yzw;
	vec3 c4 = s3.xyz;
	vec3 c5 = vec3( s3.w, s4.xy );
	vec3 c6 = vec3( s4.zw, s5.x );
	vec3 c7 = s5.yzw;
	vec3 c8 = s6.xyz;
	float x = worldNormal.x, y = worldNormal.y, z = worldNormal.z;
	vec3 result = c0 * 0.886227;
	result += c1 * 2.0 * 0.511664 * y;
	result += c2 * 2.0 * 0.511664 * z;
	result += c3 * 2.0 * 0.511664 * x;
	result += c4 * 2.0 * 0.429043 * x * y;
	result += c5 * 2.0 * 0.429043 * y * z;
	result += c6 * ( 0.743125 * z * z - 0.247708 );
	result += c7 * 2.0 * 0.429043 * x * z;
	result += c8 * 0.429043 * ( x * x - y * y );
	return max( result, vec3( 0.0 ) );
}
#endif`,Xy=`#if defined( USE_LOGARITHMIC_DEPTH_BUFFER )
	gl_FragDepth = vIsPerspective == 0.0 ? gl_FragCoord.z : log2( vFragDepth ) * logDepthBufFC * 0.5;
#endif`,qy=`#if defined( USE_LOGARITHMIC_DEPTH_BUFFER )
	uniform float logDepthBufFC;
	varying float vFragDepth;
	varying float vIsPerspective;
#endif`,Yy=`#ifdef USE_LOGARITHMIC_DEPTH_BUFFER
	varying float vFragDepth;
	varying float vIsPerspective;
#endif`,Zy=`#ifdef USE_LOGARITHMIC_DEPTH_BUFFER
	vFragDepth = 1.0 + gl_Position.w;
	vIsPerspective = float( isPerspectiveMatrix( projectionMatrix ) );
#endif`,Jy=`#ifdef USE_MAP
	vec4 sampledDiffuseColor = texture2D( map, vMapUv );
	#ifdef DECODE_VIDEO_TEXTURE
		sampledDiffuseColor = sRGBTransferEOTF( sampledDiffuseColor );
	#endif
	diffuseColor *= sampledDiffuseColor;
#endif`,Ky=`#ifdef USE_MAP
	uniform sampler2D map;
#endif`,jy=`#if defined( USE_MAP ) || defined( USE_ALPHAMAP )
	#if defined( USE_POINTS_UV )
		vec2 uv = vUv;
	#else
		vec2 uv = ( uvTransform * vec3( gl_PointCoord.x, 1.0 - gl_PointCoord.y, 1 ) ).xy;
	#endif
#endif
#ifdef USE_MAP
	diffuseColor *= texture2D( map, uv );
#endif
#ifdef USE_ALPHAMAP
	diffuseColor.a *= texture2D( alphaMap, uv ).g;
#endif`,Qy=`#if defined( USE_POINTS_UV )
	varying vec2 vUv;
#else
	#if defined( USE_MAP ) || defined( USE_ALPHAMAP )
		uniform mat3 uvTransform;
	#endif
#endif
#ifdef USE_MAP
	uniform sampler2D map;
#endif
#ifdef USE_ALPHAMAP
	uniform sampler2D alphaMap;
#endif`,tx=`float metalnessFactor = metalness;
#ifdef USE_METALNESSMAP
	vec4 texelMetalness = texture2D( metalnessMap, vMetalnessMapUv );
	metalnessFactor *= texelMetalness.b;
#endif`,ex=`#ifdef USE_METALNESSMAP
	uniform sampler2D metalnessMap;
#endif`,nx=`#ifdef USE_INSTANCING_MORPH
	float morphTargetInfluences[ MORPHTARGETS_COUNT ];
	float morphTargetBaseInfluence = texelFetch( morphTexture, ivec2( 0, gl_InstanceID ), 0 ).r;
	for ( int i = 0; i < MORPHTARGETS_COUNT; i ++ ) {
		morphTargetInfluences[i] =  texelFetch( morphTexture, ivec2( i + 1, gl_InstanceID ), 0 ).r;
	}
#endif`,ix=`#if defined( USE_MORPHCOLORS )
	#if defined( USE_COLOR_ALPHA )
		vColor *= morphTargetBaseInfluence;
	#elif defined( USE_COLOR )
		vColor.rgb *= morphTargetBaseInfluence;
	#endif
	for ( int i = 0; i < MORPHTARGETS_COUNT; i ++ ) {
		#if defined( USE_COLOR_ALPHA )
			if ( morphTargetInfluences[ i ] != 0.0 ) vColor += getMorph( gl_VertexID, i, 2 ) * morphTargetInfluences[ i ];
		#elif defined( USE_COLOR )
			if ( morphTargetInfluences[ i ] != 0.0 ) vColor.rgb += getMorph( gl_VertexID, i, 2 ).rgb * morphTargetInfluences[ i ];
		#endif
	}
#endif`,sx=`#ifdef USE_MORPHNORMALS
	objectNormal *= morphTargetBaseInfluence;
	for ( int i = 0; i < MORPHTARGETS_COUNT; i ++ ) {
		if ( morphTargetInfluences[ i ] != 0.0 ) objectNormal += getMorph( gl_VertexID, i, 1 ).xyz * morphTargetInfluences[ i ];
	}
#endif`,rx=`#ifdef USE_MORPHTARGETS
	#ifndef USE_INSTANCING_MORPH
		uniform float morphTargetBaseInfluence;
		uniform float morphTargetInfluences[ MORPHTARGETS_COUNT ];
	#endif
	uniform sampler2DArray morphTargetsTexture;
	uniform ivec2 morphTargetsTextureSize;
	vec4 getMorph( const in int vertexIndex, const in int morphTargetIndex, const in int offset ) {
		int texelIndex = vertexIndex * MORPHTARGETS_TEXTURE_STRIDE + offset;
		int y = texelIndex / morphTargetsTextureSize.x;
		int x = texelIndex - y * morphTargetsTextureSize.x;
		ivec3 morphUV = ivec3( x, y, morphTargetIndex );
		return texelFetch( morphTargetsTexture, morphUV, 0 );
	}
#endif`,ox=`#ifdef USE_MORPHTARGETS
	transformed *= morphTargetBaseInfluence;
	for ( int i = 0; i < MORPHTARGETS_COUNT; i ++ ) {
		if ( morphTargetInfluences[ i ] != 0.0 ) transformed += getMorph( gl_VertexID, i, 0 ).xyz * morphTargetInfluences[ i ];
	}
#endif`,ax=`float faceDirection = gl_FrontFacing ? 1.0 : - 1.0;
#ifdef FLAT_SHADED
	vec3 fdx = dFdx( vViewPosition );
	vec3 fdy = dFdy( vViewPosition );
	vec3 normal = normalize( cross( fdx, fdy ) );
#else
	vec3 normal = normalize( vNormal );
	#ifdef DOUBLE_SIDED
		normal *= faceDirection;
	#endif
#endif
#if defined( USE_NORMALMAP_TANGENTSPACE ) || defined( USE_CLEARCOAT_NORMALMAP ) || defined( USE_ANISOTROPY )
	#ifdef USE_TANGENT
		mat3 tbn = mat3( normalize( vTangent ), normalize( vBitangent ), normal );
	#else
		mat3 tbn = getTangentFrame( - vViewPosition, normal,
		#if defined( USE_NORMALMAP )
			vNormalMapUv
		#elif defined( USE_CLEARCOAT_NORMALMAP )
			vClearcoatNormalMapUv
		#else
			vUv
		#endif
		);
	#endif
	#ifdef DOUBLE_SIDED
		tbn[0] *= faceDirection;
		tbn[1] *= faceDirection;
	#endif
#endif
#ifdef USE_CLEARCOAT_NORMALMAP
	#ifdef USE_TANGENT
		mat3 tbn2 = mat3( normalize( vTangent ), normalize( vBitangent ), normal );
	#else
		mat3 tbn2 = getTangentFrame( - vViewPosition, normal, vClearcoatNormalMapUv );
	#endif
	#ifdef DOUBLE_SIDED
		tbn2[0] *= faceDirection;
		tbn2[1] *= faceDirection;
	#endif
#endif
vec3 nonPerturbedNormal = normal;`,lx=`#ifdef USE_NORMALMAP_OBJECTSPACE
	normal = texture2D( normalMap, vNormalMapUv ).xyz * 2.0 - 1.0;
	#ifdef FLIP_SIDED
		normal = - normal;
	#endif
	#ifdef DOUBLE_SIDED
		normal = normal * faceDirection;
	#endif
	normal = normalize( normalMatrix * normal );
#elif defined( USE_NORMALMAP_TANGENTSPACE )
	vec3 mapN = texture2D( normalMap, vNormalMapUv ).xyz * 2.0 - 1.0;
	#if defined( USE_PACKED_NORMALMAP )
		mapN = vec3( mapN.xy, sqrt( saturate( 1.0 - dot( mapN.xy, mapN.xy ) ) ) );
	#endif
	mapN.xy *= normalScale;
	normal = normalize( tbn * mapN );
#elif defined( USE_BUMPMAP )
	normal = perturbNormalArb( - vViewPosition, normal, dHdxy_fwd(), faceDirection );
#endif`,cx=`#ifndef FLAT_SHADED
	varying vec3 vNormal;
	#ifdef USE_TANGENT
		varying vec3 vTangent;
		varying vec3 vBitangent;
	#endif
#endif`,hx=`#ifndef FLAT_SHADED
	varying vec3 vNormal;
	#ifdef USE_TANGENT
		varying vec3 vTangent;
		varying vec3 vBitangent;
	#endif
#endif`,ux=`#ifndef FLAT_SHADED
	vNormal = normalize( transformedNormal );
	#ifdef USE_TANGENT
		vTangent = normalize( transformedTangent );
		vBitangent = normalize( cross( vNormal, vTangent ) * tangent.w );
		#ifdef FLIP_SIDED
			vBitangent = - vBitangent;
		#endif
	#endif
#endif`,dx=`#ifdef USE_NORMALMAP
	uniform sampler2D normalMap;
	uniform vec2 normalScale;
#endif
#ifdef USE_NORMALMAP_OBJECTSPACE
	uniform mat3 normalMatrix;
#endif
#if ! defined ( USE_TANGENT ) && ( defined ( USE_NORMALMAP_TANGENTSPACE ) || defined ( USE_CLEARCOAT_NORMALMAP ) || defined( USE_ANISOTROPY ) )
	mat3 getTangentFrame( vec3 eye_pos, vec3 surf_norm, vec2 uv ) {
		vec3 q0 = dFdx( eye_pos.xyz );
		vec3 q1 = dFdy( eye_pos.xyz );
		vec2 st0 = dFdx( uv.st );
		vec2 st1 = dFdy( uv.st );
		vec3 N = surf_norm;
		vec3 q1perp = cross( q1, N );
		vec3 q0perp = cross( N, q0 );
		vec3 T = q1perp * st0.x + q0perp * st1.x;
		vec3 B = q1perp * st0.y + q0perp * st1.y;
		float det = max( dot( T, T ), dot( B, B ) );
		float scale = ( det == 0.0 ) ? 0.0 : inversesqrt( det );
		return mat3( T * scale, B * scale, N );
	}
#endif`,fx=`#ifdef USE_CLEARCOAT
	vec3 clearcoatNormal = nonPerturbedNormal;
#endif`,px=`#ifdef USE_CLEARCOAT_NORMALMAP
	vec3 clearcoatMapN = texture2D( clearcoatNormalMap, vClearcoatNormalMapUv ).xyz * 2.0 - 1.0;
	clearcoatMapN.xy *= clearcoatNormalScale;
	clearcoatNormal = normalize( tbn2 * clearcoatMapN );
#endif`,mx=`#ifdef USE_CLEARCOATMAP
	uniform sampler2D clearcoatMap;
#endif
#ifdef USE_CLEARCOAT_NORMALMAP
	uniform sampler2D clearcoatNormalMap;
	uniform vec2 clearcoatNormalScale;
#endif
#ifdef USE_CLEARCOAT_ROUGHNESSMAP
	uniform sampler2D clearcoatRoughnessMap;
#endif`,gx=`#ifdef USE_IRIDESCENCEMAP
	uniform sampler2D iridescenceMap;
#endif
#ifdef USE_IRIDESCENCE_THICKNESSMAP
	uniform sampler2D iridescenceThicknessMap;
#endif`,_x=`#ifdef OPAQUE
diffuseColor.a = 1.0;
#endif
#ifdef USE_TRANSMISSION
diffuseColor.a *= material.transmissionAlpha;
#endif
gl_FragColor = vec4( outgoingLight, diffuseColor.a );`,yx=`vec3 packNormalToRGB( const in vec3 normal ) {
	return normalize( normal ) * 0.5 + 0.5;
}
vec3 unpackRGBToNormal( const in vec3 rgb ) {
	return 2.0 * rgb.xyz - 1.0;
}
const float PackUpscale = 256. / 255.;const float UnpackDownscale = 255. / 256.;const float ShiftRight8 = 1. / 256.;
const float Inv255 = 1. / 255.;
const vec4 PackFactors = vec4( 1.0, 256.0, 256.0 * 256.0, 256.0 * 256.0 * 256.0 );
const vec2 UnpackFactors2 = vec2( UnpackDownscale, 1.0 / PackFactors.g );
const vec3 UnpackFactors3 = vec3( UnpackDownscale / PackFactors.rg, 1.0 / PackFactors.b );
const vec4 UnpackFactors4 = vec4( UnpackDownscale / PackFactors.rgb, 1.0 / PackFactors.a );
vec4 packDepthToRGBA( const in float v ) {
	if( v <= 0.0 )
		return vec4( 0., 0., 0., 0. );
	if( v >= 1.0 )
		return vec4( 1., 1., 1., 1. );
	float vuf;
	float af = modf( v * PackFactors.a, vuf );
	float bf = modf( vuf * ShiftRight8, vuf );
	float gf = modf( vuf * ShiftRight8, vuf );
	return vec4( vuf * Inv255, gf * PackUpscale, bf * PackUpscale, af );
}
vec3 packDepthToRGB( const in float v ) {
	if( v <= 0.0 )
		return vec3( 0., 0., 0. );
	if( v >= 1.0 )
		return vec3( 1., 1., 1. );
	float vuf;
	float bf = modf( v * PackFactors.b, vuf );
	float gf = modf( vuf * ShiftRight8, vuf );
	return vec3( vuf * Inv255, gf * PackUpscale, bf );
}
vec2 packDepthToRG( const in float v ) {
	if( v <= 0.0 )
		return vec2( 0., 0. );
	if( v >= 1.0 )
		return vec2( 1., 1. );
	float vuf;
	float gf = modf( v * 256., vuf );
	return vec2( vuf * Inv255, gf );
}
float unpackRGBAToDepth( const in vec4 v ) {
	return dot( v, UnpackFactors4 );
}
float unpackRGBToDepth( const in vec3 v ) {
	return dot( v, UnpackFactors3 );
}
float unpackRGToDepth( const in vec2 v ) {
	return v.r * UnpackFactors2.r + v.g * UnpackFactors2.g;
}
vec4 pack2HalfToRGBA( const in vec2 v ) {
	vec4 r = vec4( v.x, fract( v.x * 255.0 ), v.y, fract( v.y * 255.0 ) );
	return vec4( r.x - r.y / 255.0, r.y, r.z - r.w / 255.0, r.w );
}
vec2 unpackRGBATo2Half( const in vec4 v ) {
	return vec2( v.x + ( v.y / 255.0 ), v.z + ( v.w / 255.0 ) );
}
float viewZToOrthographicDepth( const in float viewZ, const in float near, const in float far ) {
	return ( viewZ + near ) / ( near - far );
}
float orthographicDepthToViewZ( const in float depth, const in float near, const in float far ) {
	#ifdef USE_REVERSED_DEPTH_BUFFER
	
		return depth * ( far - near ) - far;
	#else
		return depth * ( near - far ) - near;
	#endif
}
float viewZToPerspectiveDepth( const in float viewZ, const in float near, const in float far ) {
	return ( ( near + viewZ ) * far ) / ( ( far - near ) * viewZ );
}
float perspectiveDepthToViewZ( const in float depth, const in float near, const in float far ) {
	
	#ifdef USE_REVERSED_DEPTH_BUFFER
		return ( near * far ) / ( ( near - far ) * depth - near );
	#else
		return ( near * far ) / ( ( far - near ) * depth - far );
	#endif
}`,xx=`#ifdef PREMULTIPLIED_ALPHA
	gl_FragColor.rgb *= gl_FragColor.a;
#endif`,vx=`vec4 mvPosition = vec4( transformed, 1.0 );
#ifdef USE_BATCHING
	mvPosition = batchingMatrix * mvPosition;
#endif
#ifdef USE_INSTANCING
	mvPosition = instanceMatrix * mvPosition;
#endif
mvPosition = modelViewMatrix * mvPosition;
gl_Position = projectionMatrix * mvPosition;`,bx=`#ifdef DITHERING
	gl_FragColor.rgb = dithering( gl_FragColor.rgb );
#endif`,Sx=`#ifdef DITHERING
	vec3 dithering( vec3 color ) {
		float grid_position = rand( gl_FragCoord.xy );
		vec3 dither_shift_RGB = vec3( 0.25 / 255.0, -0.25 / 255.0, 0.25 / 255.0 );
		dither_shift_RGB = mix( 2.0 * dither_shift_RGB, -2.0 * dither_shift_RGB, grid_position );
		return color + dither_shift_RGB;
	}
#endif`,Mx=`float roughnessFactor = roughness;
#ifdef USE_ROUGHNESSMAP
	vec4 texelRoughness = texture2D( roughnessMap, vRoughnessMapUv );
	roughnessFactor *= texelRoughness.g;
#endif`,wx=`#ifdef USE_ROUGHNESSMAP
	uniform sampler2D roughnessMap;
#endif`,Ax=`#if NUM_SPOT_LIGHT_COORDS > 0
	varying vec4 vSpotLightCoord[ NUM_SPOT_LIGHT_COORDS ];
#endif
#if NUM_SPOT_LIGHT_MAPS > 0
	uniform sampler2D spotLightMap[ NUM_SPOT_LIGHT_MAPS ];
#endif
#ifdef USE_SHADOWMAP
	#if NUM_SUN_LIGHT_SHADOWS > 0
		#define SUN_LIGHT_CASCADES 2
		#if defined( SHADOWMAP_TYPE_PCF )
			uniform sampler2DShadow sunShadowMap[ NUM_SUN_LIGHT_SHADOWS ];
		#else
			uniform sampler2D sunShadowMap[ NUM_SUN_LIGHT_SHADOWS ];
		#endif
		uniform mat4 sunShadowMatrix[ NUM_SUN_LIGHT_SHADOWS * SUN_LIGHT_CASCADES ];
		uniform vec4 sunShadowCascade[ NUM_SUN_LIGHT_SHADOWS * SUN_LIGHT_CASCADES ];
		varying vec4 vSunShadowWorldPosition;
		varying vec3 vSunShadowWorldNormal;
		struct SunLightShadow {
			float shadowIntensity;
			float shadowBias;
			float shadowNormalBias;
			float shadowRadius;
			vec2 shadowMapSize;
		};
		uniform SunLightShadow sunLightShadows[ NUM_SUN_LIGHT_SHADOWS ];
	#endif
	#if NUM_DIR_LIGHT_SHADOWS > 0
		#if defined( SHADOWMAP_TYPE_PCF )
			uniform sampler2DShadow directionalShadowMap[ NUM_DIR_LIGHT_SHADOWS ];
		#else
			uniform sampler2D directionalShadowMap[ NUM_DIR_LIGHT_SHADOWS ];
		#endif
		varying vec4 vDirectionalShadowCoord[ NUM_DIR_LIGHT_SHADOWS ];
		struct DirectionalLightShadow {
			float shadowIntensity;
			float shadowBias;
			float shadowNormalBias;
			float shadowRadius;
			vec2 shadowMapSize;
		};
		uniform DirectionalLightShadow directionalLightShadows[ NUM_DIR_LIGHT_SHADOWS ];
	#endif
	#if NUM_SPOT_LIGHT_SHADOWS > 0
		#if defined( SHADOWMAP_TYPE_PCF )
			uniform sampler2DShadow spotShadowMap[ NUM_SPOT_LIGHT_SHADOWS ];
		#else
			uniform sampler2D spotShadowMap[ NUM_SPOT_LIGHT_SHADOWS ];
		#endif
		struct SpotLightShadow {
			float shadowIntensity;
			float shadowBias;
			float shadowNormalBias;
			float shadowRadius;
			vec2 shadowMapSize;
		};
		uniform SpotLightShadow spotLightShadows[ NUM_SPOT_LIGHT_SHADOWS ];
	#endif
	#if NUM_POINT_LIGHT_SHADOWS > 0
		#if defined( SHADOWMAP_TYPE_PCF )
			uniform samplerCubeShadow pointShadowMap[ NUM_POINT_LIGHT_SHADOWS ];
		#elif defined( SHADOWMAP_TYPE_BASIC )
			uniform samplerCube pointShadowMap[ NUM_POINT_LIGHT_SHADOWS ];
		#endif
		varying vec4 vPointShadowCoord[ NUM_POINT_LIGHT_SHADOWS ];
		struct PointLightShadow {
			float shadowIntensity;
			float shadowBias;
			float shadowNormalBias;
			float shadowRadius;
			vec2 shadowMapSize;
			float shadowCameraNear;
			float shadowCameraFar;
		};
		uniform PointLightShadow pointLightShadows[ NUM_POINT_LIGHT_SHADOWS ];
	#endif
	#if defined( SHADOWMAP_TYPE_PCF )
		float interleavedGradientNoise( vec2 position ) {
			return fract( 52.9829189 * fract( dot( position, vec2( 0.06711056, 0.00583715 ) ) ) );
		}
		vec2 vogelDiskSample( int sampleIndex, int samplesCount, float phi ) {
			const float goldenAngle = 2.399963229728653;
			float r = sqrt( ( float( sampleIndex ) + 0.5 ) / float( samplesCount ) );
			float theta = float( sampleIndex ) * goldenAngle + phi;
			return vec2( cos( theta ), sin( theta ) ) * r;
		}
	#endif
	#if defined( SHADOWMAP_TYPE_PCF )
		float getShadow( sampler2DShadow shadowMap, vec2 shadowMapSize, float shadowIntensity, float shadowBias, float shadowRadius, vec4 shadowCoord ) {
			float shadow = 1.0;
			shadowCoord.xyz /= shadowCoord.w;
			#ifdef USE_REVERSED_DEPTH_BUFFER
				shadowCoord.z -= shadowBias;
			#else
				shadowCoord.z += shadowBias;
			#endif
			bool inFrustum = shadowCoord.x >= 0.0 && shadowCoord.x <= 1.0 && shadowCoord.y >= 0.0 && shadowCoord.y <= 1.0;
			bool frustumTest = inFrustum && shadowCoord.z <= 1.0;
			if ( frustumTest ) {
				vec2 texelSize = vec2( 1.0 ) / shadowMapSize;
				vec2 radius = shadowRadius * texelSize;
				float phi = interleavedGradientNoise( gl_FragCoord.xy ) * PI2;
				shadow = (
					texture( shadowMap, vec3( shadowCoord.xy + vogelDiskSample( 0, 5, phi ) * radius, shadowCoord.z ) ) +
					texture( shadowMap, vec3( shadowCoord.xy + vogelDiskSample( 1, 5, phi ) * radius, shadowCoord.z ) ) +
					texture( shadowMap, vec3( shadowCoord.xy + vogelDiskSample( 2, 5, phi ) * radius, shadowCoord.z ) ) +
					texture( shadowMap, vec3( shadowCoord.xy + vogelDiskSample( 3, 5, phi ) * radius, shadowCoord.z ) ) +
					texture( shadowMap, vec3( shadowCoord.xy + vogelDiskSample( 4, 5, phi ) * radius, shadowCoord.z ) )
				) * 0.2;
			}
			return mix( 1.0, shadow, shadowIntensity );
		}
	#elif defined( SHADOWMAP_TYPE_VSM )
		float getShadow( sampler2D shadowMap, vec2 shadowMapSize, float shadowIntensity, float shadowBias, float shadowRadius, vec4 shadowCoord ) {
			float shadow = 1.0;
			shadowCoord.xyz /= shadowCoord.w;
			#ifdef USE_REVERSED_DEPTH_BUFFER
				shadowCoord.z -= shadowBias;
			#else
				shadowCoord.z += shadowBias;
			#endif
			bool inFrustum = shadowCoord.x >= 0.0 && shadowCoord.x <= 1.0 && shadowCoord.y >= 0.0 && shadowCoord.y <= 1.0;
			bool frustumTest = inFrustum && shadowCoord.z <= 1.0;
			if ( frustumTest ) {
				vec2 distribution = texture2D( shadowMap, shadowCoord.xy ).rg;
				float mean = distribution.x;
				float variance = distribution.y * distribution.y;
				#ifdef USE_REVERSED_DEPTH_BUFFER
					float hard_shadow = step( mean, shadowCoord.z );
				#else
					float hard_shadow = step( shadowCoord.z, mean );
				#endif
				
				if ( hard_shadow == 1.0 ) {
					shadow = 1.0;
				} else {
					variance = max( variance, 0.0000001 );
					float d = shadowCoord.z - mean;
					float p_max = variance / ( variance + d * d );
					p_max = clamp( ( p_max - 0.3 ) / 0.65, 0.0, 1.0 );
					shadow = max( hard_shadow, p_max );
				}
			}
			return mix( 1.0, shadow, shadowIntensity );
		}
	#else
		float getShadow( sampler2D shadowMap, vec2 shadowMapSize, float shadowIntensity, float shadowBias, float shadowRadius, vec4 shadowCoord ) {
			float shadow = 1.0;
			shadowCoord.xyz /= shadowCoord.w;
			#ifdef USE_REVERSED_DEPTH_BUFFER
				shadowCoord.z -= shadowBias;
			#else
				shadowCoord.z += shadowBias;
			#endif
			bool inFrustum = shadowCoord.x >= 0.0 && shadowCoord.x <= 1.0 && shadowCoord.y >= 0.0 && shadowCoord.y <= 1.0;
			bool frustumTest = inFrustum && shadowCoord.z <= 1.0;
			if ( frustumTest ) {
				float depth = texture2D( shadowMap, shadowCoord.xy ).r;
				#ifdef USE_REVERSED_DEPTH_BUFFER
					shadow = step( depth, shadowCoord.z );
				#else
					shadow = step( shadowCoord.z, depth );
				#endif
			}
			return mix( 1.0, shadow, shadowIntensity );
		}
	#endif
	#if NUM_SUN_LIGHT_SHADOWS > 0
		float getSunShadow(
			#if defined( SHADOWMAP_TYPE_PCF )
				sampler2DShadow shadowMap,
			#else
				sampler2D shadowMap,
			#endif
			SunLightShadow sunLightShadow,
			int shadowIndex
		) {
			vec4 shadowWorldPosition = vec4( vSunShadowWorldPosition.xyz + vSunShadowWorldNormal * sunLightShadow.shadowNormalBias, 1.0 );
			float viewDepth = vSunShadowWorldPosition.w;
			int cascadeOffset = shadowIndex * SUN_LIGHT_CASCADES;
			float shadow = 1.0;
			for ( int i = SUN_LIGHT_CASCADES - 1; i >= 0; i -- ) {
				vec4 cascade = sunShadowCascade[ cascadeOffset + i ];
				if ( viewDepth >= cascade.x && viewDepth < cascade.y ) {
					float cascadeShadow = getShadow(
						shadowMap,
						sunLightShadow.shadowMapSize,
						sunLightShadow.shadowIntensity,
						sunLightShadow.shadowBias,
						sunLightShadow.shadowRadius,
						sunShadowMatrix[ cascadeOffset + i ] * shadowWorldPosition
					);
					shadow = mix( cascadeShadow, shadow, smoothstep( cascade.z, cascade.y, viewDepth ) );
				}
			}
			return shadow;
		}
	#endif
	#if NUM_POINT_LIGHT_SHADOWS > 0
	#if defined( SHADOWMAP_TYPE_PCF )
	float getPointShadow( samplerCubeShadow shadowMap, vec2 shadowMapSize, float shadowIntensity, float shadowBias, float shadowRadius, vec4 shadowCoord, float shadowCameraNear, float shadowCameraFar ) {
		float shadow = 1.0;
		vec3 lightToPosition = shadowCoord.xyz;
		vec3 bd3D = normalize( lightToPosition );
		vec3 absVec = abs( lightToPosition );
		float viewSpaceZ = max( max( absVec.x, absVec.y ), absVec.z );
		if ( viewSpaceZ - shadowCameraFar <= 0.0 && viewSpaceZ - shadowCameraNear >= 0.0 ) {
			float lightDistance = length( lightToPosition );
			float depthRange = shadowCameraFar - shadowCameraNear;
			#ifdef USE_REVERSED_DEPTH_BUFFER
				float depthA = - shadowCameraNear / depthRange - shadowBias;
				float depthB = shadowCameraNear * shadowCameraFar / ( depthRange * lightDistance );
			#else
				float depthA = shadowCameraFar / depthRange + shadowBias;
				float depthB = - shadowCameraNear * shadowCameraFar / ( depthRange * lightDistance );
			#endif
			float texelSize = shadowRadius / shadowMapSize.x;
			vec3 absDir = abs( bd3D );
			vec3 tangent = absDir.x > absDir.z ? vec3( 0.0, 1.0, 0.0 ) : vec3( 1.0, 0.0, 0.0 );
			tangent = normalize( cross( bd3D, tangent ) );
			vec3 bitangent = cross( bd3D, tangent );
			float phi = interleavedGradientNoise( gl_FragCoord.xy ) * PI2;
			shadow = 0.0;
			for ( int i = 0; i < 5; i ++ ) {
				vec2 offset = vogelDiskSample( i, 5, phi );
				vec3 direction = bd3D + ( tangent * offset.x + bitangent * offset.y ) * texelSize;
				vec3 absDirection = abs( direction );
				float dp = depthA + depthB / max( max( absDirection.x, absDirection.y ), absDirection.z );
				shadow += texture( shadowMap, vec4( direction, dp ) );
			}
			shadow *= 0.2;
		}
		return mix( 1.0, shadow, shadowIntensity );
	}
	#elif defined( SHADOWMAP_TYPE_BASIC )
	float getPointShadow( samplerCube shadowMap, vec2 shadowMapSize, float shadowIntensity, float shadowBias, float shadowRadius, vec4 shadowCoord, float shadowCameraNear, float shadowCameraFar ) {
		float shadow = 1.0;
		vec3 lightToPosition = shadowCoord.xyz;
		vec3 absVec = abs( lightToPosition );
		float viewSpaceZ = max( max( absVec.x, absVec.y ), absVec.z );
		if ( viewSpaceZ - shadowCameraFar <= 0.0 && viewSpaceZ - shadowCameraNear >= 0.0 ) {
			float dp = ( shadowCameraFar * ( viewSpaceZ - shadowCameraNear ) ) / ( viewSpaceZ * ( shadowCameraFar - shadowCameraNear ) );
			dp += shadowBias;
			vec3 bd3D = normalize( lightToPosition );
			float depth = textureCube( shadowMap, bd3D ).r;
			#ifdef USE_REVERSED_DEPTH_BUFFER
				depth = 1.0 - depth;
			#endif
			shadow = step( dp, depth );
		}
		return mix( 1.0, shadow, shadowIntensity );
	}
	#endif
	#endif
#endif`,Ex=`#if NUM_SPOT_LIGHT_COORDS > 0
	uniform mat4 spotLightMatrix[ NUM_SPOT_LIGHT_COORDS ];
	varying vec4 vSpotLightCoord[ NUM_SPOT_LIGHT_COORDS ];
#endif
#ifdef USE_SHADOWMAP
	#if NUM_SUN_LIGHT_SHADOWS > 0
		varying vec4 vSunShadowWorldPosition;
		varying vec3 vSunShadowWorldNormal;
	#endif
	#if NUM_DIR_LIGHT_SHADOWS > 0
		uniform mat4 directionalShadowMatrix[ NUM_DIR_LIGHT_SHADOWS ];
		varying vec4 vDirectionalShadowCoord[ NUM_DIR_LIGHT_SHADOWS ];
		struct DirectionalLightShadow {
			float shadowIntensity;
			float shadowBias;
			float shadowNormalBias;
			float shadowRadius;
			vec2 shadowMapSize;
		};
		uniform DirectionalLightShadow directionalLightShadows[ NUM_DIR_LIGHT_SHADOWS ];
	#endif
	#if NUM_SPOT_LIGHT_SHADOWS > 0
		struct SpotLightShadow {
			float shadowIntensity;
			float shadowBias;
			float shadowNormalBias;
			float shadowRadius;
			vec2 shadowMapSize;
		};
		uniform SpotLightShadow spotLightShadows[ NUM_SPOT_LIGHT_SHADOWS ];
	#endif
	#if NUM_POINT_LIGHT_SHADOWS > 0
		uniform mat4 pointShadowMatrix[ NUM_POINT_LIGHT_SHADOWS ];
		varying vec4 vPointShadowCoord[ NUM_POINT_LIGHT_SHADOWS ];
		struct PointLightShadow {
			float shadowIntensity;
			float shadowBias;
			float shadowNormalBias;
			float shadowRadius;
			vec2 shadowMapSize;
			float shadowCameraNear;
			float shadowCameraFar;
		};
		uniform PointLightShadow pointLightShadows[ NUM_POINT_LIGHT_SHADOWS ];
	#endif
#endif`,Tx=`#if ( defined( USE_SHADOWMAP ) && ( NUM_DIR_LIGHT_SHADOWS > 0 || NUM_SUN_LIGHT_SHADOWS > 0 || NUM_POINT_LIGHT_SHADOWS > 0 ) ) || ( NUM_SPOT_LIGHT_COORDS > 0 )
	#ifdef HAS_NORMAL
		vec3 shadowWorldNormal = transformNormalByInverseViewMatrix( transformedNormal, viewMatrix );
	#else
		vec3 shadowWorldNormal = vec3( 0.0 );
	#endif
	vec4 shadowWorldPosition;
#endif
#if defined( USE_SHADOWMAP )
	#if NUM_SUN_LIGHT_SHADOWS > 0
		vSunShadowWorldPosition = vec4( worldPosition.xyz, - mvPosition.z );
		vSunShadowWorldNormal = shadowWorldNormal;
	#endif
	#if NUM_DIR_LIGHT_SHADOWS > 0
		#pragma unroll_loop_start
		for ( int i = 0; i < NUM_DIR_LIGHT_SHADOWS; i ++ ) {
			shadowWorldPosition = worldPosition + vec4( shadowWorldNormal * directionalLightShadows[ i ].shadowNormalBias, 0 );
			vDirectionalShadowCoord[ i ] = directionalShadowMatrix[ i ] * shadowWorldPosition;
		}
		#pragma unroll_loop_end
	#endif
	#if NUM_POINT_LIGHT_SHADOWS > 0
		#pragma unroll_loop_start
		for ( int i = 0; i < NUM_POINT_LIGHT_SHADOWS; i ++ ) {
			shadowWorldPosition = worldPosition + vec4( shadowWorldNormal * pointLightShadows[ i ].shadowNormalBias, 0 );
			vPointShadowCoord[ i ] = pointShadowMatrix[ i ] * shadowWorldPosition;
		}
		#pragma unroll_loop_end
	#endif
#endif
#if NUM_SPOT_LIGHT_COORDS > 0
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_SPOT_LIGHT_COORDS; i ++ ) {
		shadowWorldPosition = worldPosition;
		#if ( defined( USE_SHADOWMAP ) && UNROLLED_LOOP_INDEX < NUM_SPOT_LIGHT_SHADOWS )
			shadowWorldPosition.xyz += shadowWorldNormal * spotLightShadows[ i ].shadowNormalBias;
		#endif
		vSpotLightCoord[ i ] = spotLightMatrix[ i ] * shadowWorldPosition;
	}
	#pragma unroll_loop_end
#endif`,Rx=`float getShadowMask() {
	float shadow = 1.0;
	#ifdef USE_SHADOWMAP
	#if NUM_SUN_LIGHT_SHADOWS > 0
	SunLightShadow sunLight;
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_SUN_LIGHT_SHADOWS; i ++ ) {
		sunLight = sunLightShadows[ i ];
		shadow *= receiveShadow ? getSunShadow( sunShadowMap[ i ], sunLight, UNROLLED_LOOP_INDEX ) : 1.0;
	}
	#pragma unroll_loop_end
	#endif
	#if NUM_DIR_LIGHT_SHADOWS > 0
	DirectionalLightShadow directionalLight;
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_DIR_LIGHT_SHADOWS; i ++ ) {
		directionalLight = directionalLightShadows[ i ];
		shadow *= receiveShadow ? getShadow( directionalShadowMap[ i ], directionalLight.shadowMapSize, directionalLight.shadowIntensity, directionalLight.shadowBias, directionalLight.shadowRadius, vDirectionalShadowCoord[ i ] ) : 1.0;
	}
	#pragma unroll_loop_end
	#endif
	#if NUM_SPOT_LIGHT_SHADOWS > 0
	SpotLightShadow spotLight;
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_SPOT_LIGHT_SHADOWS; i ++ ) {
		spotLight = spotLightShadows[ i ];
		shadow *= receiveShadow ? getShadow( spotShadowMap[ i ], spotLight.shadowMapSize, spotLight.shadowIntensity, spotLight.shadowBias, spotLight.shadowRadius, vSpotLightCoord[ i ] ) : 1.0;
	}
	#pragma unroll_loop_end
	#endif
	#if NUM_POINT_LIGHT_SHADOWS > 0 && ( defined( SHADOWMAP_TYPE_PCF ) || defined( SHADOWMAP_TYPE_BASIC ) )
	PointLightShadow pointLight;
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_POINT_LIGHT_SHADOWS; i ++ ) {
		pointLight = pointLightShadows[ i ];
		shadow *= receiveShadow ? getPointShadow( pointShadowMap[ i ], pointLight.shadowMapSize, pointLight.shadowIntensity, pointLight.shadowBias, pointLight.shadowRadius, vPointShadowCoord[ i ], pointLight.shadowCameraNear, pointLight.shadowCameraFar ) : 1.0;
	}
	#pragma unroll_loop_end
	#endif
	#endif
	return shadow;
}`,Cx=`#ifdef USE_SKINNING
	mat4 boneMatX = getBoneMatrix( skinIndex.x );
	mat4 boneMatY = getBoneMatrix( skinIndex.y );
	mat4 boneMatZ = getBoneMatrix( skinIndex.z );
	mat4 boneMatW = getBoneMatrix( skinIndex.w );
#endif`,Px=`#ifdef USE_SKINNING
	uniform mat4 bindMatrix;
	uniform mat4 bindMatrixInverse;
	uniform highp sampler2D boneTexture;
	mat4 getBoneMatrix( const in float i ) {
		int size = textureSize( boneTexture, 0 ).x;
		int j = int( i ) * 4;
		int x = j % size;
		int y = j / size;
		vec4 v1 = texelFetch( boneTexture, ivec2( x, y ), 0 );
		vec4 v2 = texelFetch( boneTexture, ivec2( x + 1, y ), 0 );
		vec4 v3 = texelFetch( boneTexture, ivec2( x + 2, y ), 0 );
		vec4 v4 = texelFetch( boneTexture, ivec2( x + 3, y ), 0 );
		return mat4( v1, v2, v3, v4 );
	}
#endif`,Ix=`#ifdef USE_SKINNING
	vec4 skinVertex = bindMatrix * vec4( transformed, 1.0 );
	vec4 skinned = vec4( 0.0 );
	skinned += boneMatX * skinVertex * skinWeight.x;
	skinned += boneMatY * skinVertex * skinWeight.y;
	skinned += boneMatZ * skinVertex * skinWeight.z;
	skinned += boneMatW * skinVertex * skinWeight.w;
	transformed = ( bindMatrixInverse * skinned ).xyz;
#endif`,Lx=`#ifdef USE_SKINNING
	mat4 skinMatrix = mat4( 0.0 );
	skinMatrix += skinWeight.x * boneMatX;
	skinMatrix += skinWeight.y * boneMatY;
	skinMatrix += skinWeight.z * boneMatZ;
	skinMatrix += skinWeight.w * boneMatW;
	skinMatrix = bindMatrixInverse * skinMatrix * bindMatrix;
	objectNormal = vec4( skinMatrix * vec4( objectNormal, 0.0 ) ).xyz;
	#ifdef USE_TANGENT
		objectTangent = vec4( skinMatrix * vec4( objectTangent, 0.0 ) ).xyz;
	#endif
#endif`,Dx=`float specularStrength;
#ifdef USE_SPECULARMAP
	vec4 texelSpecular = texture2D( specularMap, vSpecularMapUv );
	specularStrength = texelSpecular.r;
#else
	specularStrength = 1.0;
#endif`,Nx=`#ifdef USE_SPECULARMAP
	uniform sampler2D specularMap;
#endif`,Fx=`#if defined( TONE_MAPPING )
	gl_FragColor.rgb = toneMapping( gl_FragColor.rgb );
#endif`,Ux=`#ifndef saturate
#define saturate( a ) clamp( a, 0.0, 1.0 )
#endif
uniform float toneMappingExposure;
vec3 LinearToneMapping( vec3 color ) {
	return saturate( toneMappingExposure * color );
}
vec3 ReinhardToneMapping( vec3 color ) {
	color *= toneMappingExposure;
	return saturate( color / ( vec3( 1.0 ) + color ) );
}
vec3 CineonToneMapping( vec3 color ) {
	color *= toneMappingExposure;
	color = max( vec3( 0.0 ), color - 0.004 );
	return pow( ( color * ( 6.2 * color + 0.5 ) ) / ( color * ( 6.2 * color + 1.7 ) + 0.06 ), vec3( 2.2 ) );
}
vec3 RRTAndODTFit( vec3 v ) {
	vec3 a = v * ( v + 0.0245786 ) - 0.000090537;
	vec3 b = v * ( 0.983729 * v + 0.4329510 ) + 0.238081;
	return a / b;
}
vec3 ACESFilmicToneMapping( vec3 color ) {
	const mat3 ACESInputMat = mat3(
		vec3( 0.59719, 0.07600, 0.02840 ),		vec3( 0.35458, 0.90834, 0.13383 ),
		vec3( 0.04823, 0.01566, 0.83777 )
	);
	const mat3 ACESOutputMat = mat3(
		vec3(  1.60475, -0.10208, -0.00327 ),		vec3( -0.53108,  1.10813, -0.07276 ),
		vec3( -0.07367, -0.00605,  1.07602 )
	);
	color *= toneMappingExposure / 0.6;
	color = ACESInputMat * color;
	color = RRTAndODTFit( color );
	color = ACESOutputMat * color;
	return saturate( color );
}
const mat3 LINEAR_REC2020_TO_LINEAR_SRGB = mat3(
	vec3( 1.6605, - 0.1246, - 0.0182 ),
	vec3( - 0.5876, 1.1329, - 0.1006 ),
	vec3( - 0.0728, - 0.0083, 1.1187 )
);
const mat3 LINEAR_SRGB_TO_LINEAR_REC2020 = mat3(
	vec3( 0.6274, 0.0691, 0.0164 ),
	vec3( 0.3293, 0.9195, 0.0880 ),
	vec3( 0.0433, 0.0113, 0.8956 )
);
vec3 agxDefaultContrastApprox( vec3 x ) {
	vec3 x2 = x * x;
	vec3 x4 = x2 * x2;
	return + 15.5 * x4 * x2
		- 40.14 * x4 * x
		+ 31.96 * x4
		- 6.868 * x2 * x
		+ 0.4298 * x2
		+ 0.1191 * x
		- 0.00232;
}
vec3 AgXToneMapping( vec3 color ) {
	const mat3 AgXInsetMatrix = mat3(
		vec3( 0.856627153315983, 0.137318972929847, 0.11189821299995 ),
		vec3( 0.0951212405381588, 0.761241990602591, 0.0767994186031903 ),
		vec3( 0.0482516061458583, 0.101439036467562, 0.811302368396859 )
	);
	const mat3 AgXOutsetMatrix = mat3(
		vec3( 1.1271005818144368, - 0.1413297634984383, - 0.14132976349843826 ),
		vec3( - 0.11060664309660323, 1.157823702216272, - 0.11060664309660294 ),
		vec3( - 0.016493938717834573, - 0.016493938717834257, 1.2519364065950405 )
	);
	const float AgxMinEv = - 12.47393;	const float AgxMaxEv = 4.026069;
	color *= toneMappingExposure;
	color = LINEAR_SRGB_TO_LINEAR_REC2020 * color;
	color = AgXInsetMatrix * color;
	color = max( color, 1e-10 );	color = log2( color );
	color = ( color - AgxMinEv ) / ( AgxMaxEv - AgxMinEv );
	color = clamp( color, 0.0, 1.0 );
	color = agxDefaultContrastApprox( color );
	color = AgXOutsetMatrix * color;
	color = pow( max( vec3( 0.0 ), color ), vec3( 2.2 ) );
	color = LINEAR_REC2020_TO_LINEAR_SRGB * color;
	color = clamp( color, 0.0, 1.0 );
	return color;
}
vec3 NeutralToneMapping( vec3 color ) {
	const float StartCompression = 0.8 - 0.04;
	const float Desaturation = 0.15;
	color *= toneMappingExposure;
	float x = min( color.r, min( color.g, color.b ) );
	float offset = x < 0.08 ? x - 6.25 * x * x : 0.04;
	color -= offset;
	float peak = max( color.r, max( color.g, color.b ) );
	if ( peak < StartCompression ) return color;
	float d = 1. - StartCompression;
	float newPeak = 1. - d * d / ( peak + d - StartCompression );
	color *= newPeak / peak;
	float g = 1. - 1. / ( Desaturation * ( peak - newPeak ) + 1. );
	return mix( color, vec3( newPeak ), g );
}
vec3 CustomToneMapping( vec3 color ) { return color; }`,Ox=`#ifdef USE_TRANSMISSION
	material.transmission = transmission;
	material.transmissionAlpha = 1.0;
	material.thickness = thickness;
	material.attenuationDistance = attenuationDistance;
	material.attenuationColor = attenuationColor;
	#ifdef USE_TRANSMISSIONMAP
		material.transmission *= texture2D( transmissionMap, vTransmissionMapUv ).r;
	#endif
	#ifdef USE_THICKNESSMAP
		material.thickness *= texture2D( thicknessMap, vThicknessMapUv ).g;
	#endif
	vec3 pos = vWorldPosition;
	vec3 v = normalize( cameraPosition - pos );
	vec3 n = transformNormalByInverseViewMatrix( normal, viewMatrix );
	vec4 transmitted = getIBLVolumeRefraction(
		n, v, material.roughness, material.diffuseContribution, material.specularColorBlended, material.specularF90,
		pos, modelMatrix, viewMatrix, projectionMatrix, material.dispersion, material.ior, material.thickness,
		material.attenuationColor, material.attenuationDistance );
	material.transmissionAlpha = mix( material.transmissionAlpha, transmitted.a, material.transmission );
	totalDiffuse = mix( totalDiffuse, transmitted.rgb, material.transmission );
#endif`,Bx=`#ifdef USE_TRANSMISSION
	uniform float transmission;
	uniform float thickness;
	uniform float attenuationDistance;
	uniform vec3 attenuationColor;
	#ifdef USE_TRANSMISSIONMAP
		uniform sampler2D transmissionMap;
	#endif
	#ifdef USE_THICKNESSMAP
		uniform sampler2D thicknessMap;
	#endif
	uniform vec2 transmissionSamplerSize;
	uniform sampler2D transmissionSamplerMap;
	uniform mat4 modelMatrix;
	uniform mat4 projectionMatrix;
	varying vec3 vWorldPosition;
	float w0( float a ) {
		return ( 1.0 / 6.0 ) * ( a * ( a * ( - a + 3.0 ) - 3.0 ) + 1.0 );
	}
	float w1( float a ) {
		return ( 1.0 / 6.0 ) * ( a *  a * ( 3.0 * a - 6.0 ) + 4.0 );
	}
	float w2( float a ){
		return ( 1.0 / 6.0 ) * ( a * ( a * ( - 3.0 * a + 3.0 ) + 3.0 ) + 1.0 );
	}
	float w3( float a ) {
		return ( 1.0 / 6.0 ) * ( a * a * a );
	}
	float g0( float a ) {
		return w0( a ) + w1( a );
	}
	float g1( float a ) {
		return w2( a ) + w3( a );
	}
	float h0( float a ) {
		return - 1.0 + w1( a ) / ( w0( a ) + w1( a ) );
	}
	float h1( float a ) {
		return 1.0 + w3( a ) / ( w2( a ) + w3( a ) );
	}
	vec4 bicubic( sampler2D tex, vec2 uv, vec4 texelSize, float lod ) {
		uv = uv * texelSize.zw + 0.5;
		vec2 iuv = floor( uv );
		vec2 fuv = fract( uv );
		float g0x = g0( fuv.x );
		float g1x = g1( fuv.x );
		float h0x = h0( fuv.x );
		float h1x = h1( fuv.x );
		float h0y = h0( fuv.y );
		float h1y = h1( fuv.y );
		vec2 p0 = ( vec2( iuv.x + h0x, iuv.y + h0y ) - 0.5 ) * texelSize.xy;
		vec2 p1 = ( vec2( iuv.x + h1x, iuv.y + h0y ) - 0.5 ) * texelSize.xy;
		vec2 p2 = ( vec2( iuv.x + h0x, iuv.y + h1y ) - 0.5 ) * texelSize.xy;
		vec2 p3 = ( vec2( iuv.x + h1x, iuv.y + h1y ) - 0.5 ) * texelSize.xy;
		return g0( fuv.y ) * ( g0x * textureLod( tex, p0, lod ) + g1x * textureLod( tex, p1, lod ) ) +
			g1( fuv.y ) * ( g0x * textureLod( tex, p2, lod ) + g1x * textureLod( tex, p3, lod ) );
	}
	vec4 textureBicubic( sampler2D sampler, vec2 uv, float lod ) {
		vec2 fLodSize = vec2( textureSize( sampler, int( lod ) ) );
		vec2 cLodSize = vec2( textureSize( sampler, int( lod + 1.0 ) ) );
		vec2 fLodSizeInv = 1.0 / fLodSize;
		vec2 cLodSizeInv = 1.0 / cLodSize;
		vec4 fSample = bicubic( sampler, uv, vec4( fLodSizeInv, fLodSize ), floor( lod ) );
		vec4 cSample = bicubic( sampler, uv, vec4( cLodSizeInv, cLodSize ), ceil( lod ) );
		return mix( fSample, cSample, fract( lod ) );
	}
	vec3 getVolumeTransmissionRay( const in vec3 n, const in vec3 v, const in float thickness, const in float ior, const in mat4 modelMatrix ) {
		vec3 refractionVector = refract( - v, normalize( n ), 1.0 / ior );
		vec3 modelScale;
		modelScale.x = length( vec3( modelMatrix[ 0 ].xyz ) );
		modelScale.y = length( vec3( modelMatrix[ 1 ].xyz ) );
		modelScale.z = length( vec3( modelMatrix[ 2 ].xyz ) );
		return normalize( refractionVector ) * thickness * modelScale;
	}
	float applyIorToRoughness( const in float roughness, const in float ior ) {
		return roughness * clamp( ior * 2.0 - 2.0, 0.0, 1.0 );
	}
	vec4 getTransmissionSample( const in vec2 fragCoord, const in float roughness, const in float ior ) {
		float lod = log2( transmissionSamplerSize.x ) * applyIorToRoughness( roughness, ior );
		return textureBicubic( transmissionSamplerMap, fragCoord.xy, lod );
	}
	vec3 volumeAttenuation( const in float transmissionDistance, const in vec3 attenuationColor, const in float attenuationDistance ) {
		if ( isinf( attenuationDistance ) ) {
			return vec3( 1.0 );
		} else {
			vec3 attenuationCoefficient = -log( attenuationColor ) / attenuationDistance;
			vec3 transmittance = exp( - attenuationCoefficient * transmissionDistance );			return transmittance;
		}
	}
	vec4 getIBLVolumeRefraction( const in vec3 n, const in vec3 v, const in float roughness, const in vec3 diffuseColor,
		const in vec3 specularColor, const in float specularF90, const in vec3 position, const in mat4 modelMatrix,
		const in mat4 viewMatrix, const in mat4 projMatrix, const in float dispersion, const in float ior, const in float thickness,
		const in vec3 attenuationColor, const in float attenuationDistance ) {
		vec4 transmittedLight;
		vec3 transmittance;
		#ifdef USE_DISPERSION
			float halfSpread = ( ior - 1.0 ) * 0.025 * dispersion;
			vec3 iors = vec3( ior - halfSpread, ior, ior + halfSpread );
			for ( int i = 0; i < 3; i ++ ) {
				vec3 transmissionRay = getVolumeTransmissionRay( n, v, thickness, iors[ i ], modelMatrix );
				vec3 refractedRayExit = position + transmissionRay;
				vec4 ndcPos = projMatrix * viewMatrix * vec4( refractedRayExit, 1.0 );
				vec2 refractionCoords = ndcPos.xy / ndcPos.w;
				refractionCoords += 1.0;
				refractionCoords /= 2.0;
				vec4 transmissionSample = getTransmissionSample( refractionCoords, roughness, iors[ i ] );
				transmittedLight[ i ] = transmissionSample[ i ];
				transmittedLight.a += transmissionSample.a;
				transmittance[ i ] = diffuseColor[ i ] * volumeAttenuation( length( transmissionRay ), attenuationColor, attenuationDistance )[ i ];
			}
			transmittedLight.a /= 3.0;
		#else
			vec3 transmissionRay = getVolumeTransmissionRay( n, v, thickness, ior, modelMatrix );
			vec3 refractedRayExit = position + transmissionRay;
			vec4 ndcPos = projMatrix * viewMatrix * vec4( refractedRayExit, 1.0 );
			vec2 refractionCoords = ndcPos.xy / ndcPos.w;
			refractionCoords += 1.0;
			refractionCoords /= 2.0;
			transmittedLight = getTransmissionSample( refractionCoords, roughness, ior );
			transmittance = diffuseColor * volumeAttenuation( length( transmissionRay ), attenuationColor, attenuationDistance );
		#endif
		vec3 attenuatedColor = transmittance * transmittedLight.rgb;
		vec3 F = EnvironmentBRDF( n, v, specularColor, specularF90, roughness );
		float transmittanceFactor = ( transmittance.r + transmittance.g + transmittance.b ) / 3.0;
		return vec4( ( 1.0 - F ) * attenuatedColor, 1.0 - ( 1.0 - transmittedLight.a ) * transmittanceFactor );
	}
#endif`,kx=`#if defined( USE_UV ) || defined( USE_ANISOTROPY )
	varying vec2 vUv;
#endif
#ifdef USE_MAP
	varying vec2 vMapUv;
#endif
#ifdef USE_ALPHAMAP
	varying vec2 vAlphaMapUv;
#endif
#ifdef USE_LIGHTMAP
	varying vec2 vLightMapUv;
#endif
#ifdef USE_AOMAP
	varying vec2 vAoMapUv;
#endif
#ifdef USE_BUMPMAP
	varying vec2 vBumpMapUv;
#endif
#ifdef USE_NORMALMAP
	varying vec2 vNormalMapUv;
#endif
#ifdef USE_EMISSIVEMAP
	varying vec2 vEmissiveMapUv;
#endif
#ifdef USE_METALNESSMAP
	varying vec2 vMetalnessMapUv;
#endif
#ifdef USE_ROUGHNESSMAP
	varying vec2 vRoughnessMapUv;
#endif
#ifdef USE_DIFFUSE_ROUGHNESSMAP
	varying vec2 vDiffuseRoughnessMapUv;
#endif
#ifdef USE_ANISOTROPYMAP
	varying vec2 vAnisotropyMapUv;
#endif
#ifdef USE_CLEARCOATMAP
	varying vec2 vClearcoatMapUv;
#endif
#ifdef USE_CLEARCOAT_NORMALMAP
	varying vec2 vClearcoatNormalMapUv;
#endif
#ifdef USE_CLEARCOAT_ROUGHNESSMAP
	varying vec2 vClearcoatRoughnessMapUv;
#endif
#ifdef USE_IRIDESCENCEMAP
	varying vec2 vIridescenceMapUv;
#endif
#ifdef USE_IRIDESCENCE_THICKNESSMAP
	varying vec2 vIridescenceThicknessMapUv;
#endif
#ifdef USE_SHEEN_COLORMAP
	varying vec2 vSheenColorMapUv;
#endif
#ifdef USE_SHEEN_ROUGHNESSMAP
	varying vec2 vSheenRoughnessMapUv;
#endif
#ifdef USE_SPECULARMAP
	varying vec2 vSpecularMapUv;
#endif
#ifdef USE_SPECULAR_COLORMAP
	varying vec2 vSpecularColorMapUv;
#endif
#ifdef USE_SPECULAR_INTENSITYMAP
	varying vec2 vSpecularIntensityMapUv;
#endif
#ifdef USE_TRANSMISSIONMAP
	uniform mat3 transmissionMapTransform;
	varying vec2 vTransmissionMapUv;
#endif
#ifdef USE_THICKNESSMAP
	uniform mat3 thicknessMapTransform;
	varying vec2 vThicknessMapUv;
#endif`,zx=`#if defined( USE_UV ) || defined( USE_ANISOTROPY )
	varying vec2 vUv;
#endif
#ifdef USE_MAP
	uniform mat3 mapTransform;
	varying vec2 vMapUv;
#endif
#ifdef USE_ALPHAMAP
	uniform mat3 alphaMapTransform;
	varying vec2 vAlphaMapUv;
#endif
#ifdef USE_LIGHTMAP
	uniform mat3 lightMapTransform;
	varying vec2 vLightMapUv;
#endif
#ifdef USE_AOMAP
	uniform mat3 aoMapTransform;
	varying vec2 vAoMapUv;
#endif
#ifdef USE_BUMPMAP
	uniform mat3 bumpMapTransform;
	varying vec2 vBumpMapUv;
#endif
#ifdef USE_NORMALMAP
	uniform mat3 normalMapTransform;
	varying vec2 vNormalMapUv;
#endif
#ifdef USE_DISPLACEMENTMAP
	uniform mat3 displacementMapTransform;
	varying vec2 vDisplacementMapUv;
#endif
#ifdef USE_EMISSIVEMAP
	uniform mat3 emissiveMapTransform;
	varying vec2 vEmissiveMapUv;
#endif
#ifdef USE_METALNESSMAP
	uniform mat3 metalnessMapTransform;
	varying vec2 vMetalnessMapUv;
#endif
#ifdef USE_ROUGHNESSMAP
	uniform mat3 roughnessMapTransform;
	varying vec2 vRoughnessMapUv;
#endif
#ifdef USE_DIFFUSE_ROUGHNESSMAP
	uniform mat3 diffuseRoughnessMapTransform;
	varying vec2 vDiffuseRoughnessMapUv;
#endif
#ifdef USE_ANISOTROPYMAP
	uniform mat3 anisotropyMapTransform;
	varying vec2 vAnisotropyMapUv;
#endif
#ifdef USE_CLEARCOATMAP
	uniform mat3 clearcoatMapTransform;
	varying vec2 vClearcoatMapUv;
#endif
#ifdef USE_CLEARCOAT_NORMALMAP
	uniform mat3 clearcoatNormalMapTransform;
	varying vec2 vClearcoatNormalMapUv;
#endif
#ifdef USE_CLEARCOAT_ROUGHNESSMAP
	uniform mat3 clearcoatRoughnessMapTransform;
	varying vec2 vClearcoatRoughnessMapUv;
#endif
#ifdef USE_SHEEN_COLORMAP
	uniform mat3 sheenColorMapTransform;
	varying vec2 vSheenColorMapUv;
#endif
#ifdef USE_SHEEN_ROUGHNESSMAP
	uniform mat3 sheenRoughnessMapTransform;
	varying vec2 vSheenRoughnessMapUv;
#endif
#ifdef USE_IRIDESCENCEMAP
	uniform mat3 iridescenceMapTransform;
	varying vec2 vIridescenceMapUv;
#endif
#ifdef USE_IRIDESCENCE_THICKNESSMAP
	uniform mat3 iridescenceThicknessMapTransform;
	varying vec2 vIridescenceThicknessMapUv;
#endif
#ifdef USE_SPECULARMAP
	uniform mat3 specularMapTransform;
	varying vec2 vSpecularMapUv;
#endif
#ifdef USE_SPECULAR_COLORMAP
	uniform mat3 specularColorMapTransform;
	varying vec2 vSpecularColorMapUv;
#endif
#ifdef USE_SPECULAR_INTENSITYMAP
	uniform mat3 specularIntensityMapTransform;
	varying vec2 vSpecularIntensityMapUv;
#endif
#ifdef USE_TRANSMISSIONMAP
	uniform mat3 transmissionMapTransform;
	varying vec2 vTransmissionMapUv;
#endif
#ifdef USE_THICKNESSMAP
	uniform mat3 thicknessMapTransform;
	varying vec2 vThicknessMapUv;
#endif`,Vx=`#if defined( USE_UV ) || defined( USE_ANISOTROPY )
	vUv = vec3( uv, 1 ).xy;
#endif
#ifdef USE_MAP
	vMapUv = ( mapTransform * vec3( MAP_UV, 1 ) ).xy;
#endif
#ifdef USE_ALPHAMAP
	vAlphaMapUv = ( alphaMapTransform * vec3( ALPHAMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_LIGHTMAP
	vLightMapUv = ( lightMapTransform * vec3( LIGHTMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_AOMAP
	vAoMapUv = ( aoMapTransform * vec3( AOMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_BUMPMAP
	vBumpMapUv = ( bumpMapTransform * vec3( BUMPMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_NORMALMAP
	vNormalMapUv = ( normalMapTransform * vec3( NORMALMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_DISPLACEMENTMAP
	vDisplacementMapUv = ( displacementMapTransform * vec3( DISPLACEMENTMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_EMISSIVEMAP
	vEmissiveMapUv = ( emissiveMapTransform * vec3( EMISSIVEMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_METALNESSMAP
	vMetalnessMapUv = ( metalnessMapTransform * vec3( METALNESSMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_ROUGHNESSMAP
	vRoughnessMapUv = ( roughnessMapTransform * vec3( ROUGHNESSMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_DIFFUSE_ROUGHNESSMAP
	vDiffuseRoughnessMapUv = ( diffuseRoughnessMapTransform * vec3( DIFFUSE_ROUGHNESSMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_ANISOTROPYMAP
	vAnisotropyMapUv = ( anisotropyMapTransform * vec3( ANISOTROPYMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_CLEARCOATMAP
	vClearcoatMapUv = ( clearcoatMapTransform * vec3( CLEARCOATMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_CLEARCOAT_NORMALMAP
	vClearcoatNormalMapUv = ( clearcoatNormalMapTransform * vec3( CLEARCOAT_NORMALMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_CLEARCOAT_ROUGHNESSMAP
	vClearcoatRoughnessMapUv = ( clearcoatRoughnessMapTransform * vec3( CLEARCOAT_ROUGHNESSMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_IRIDESCENCEMAP
	vIridescenceMapUv = ( iridescenceMapTransform * vec3( IRIDESCENCEMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_IRIDESCENCE_THICKNESSMAP
	vIridescenceThicknessMapUv = ( iridescenceThicknessMapTransform * vec3( IRIDESCENCE_THICKNESSMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_SHEEN_COLORMAP
	vSheenColorMapUv = ( sheenColorMapTransform * vec3( SHEEN_COLORMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_SHEEN_ROUGHNESSMAP
	vSheenRoughnessMapUv = ( sheenRoughnessMapTransform * vec3( SHEEN_ROUGHNESSMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_SPECULARMAP
	vSpecularMapUv = ( specularMapTransform * vec3( SPECULARMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_SPECULAR_COLORMAP
	vSpecularColorMapUv = ( specularColorMapTransform * vec3( SPECULAR_COLORMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_SPECULAR_INTENSITYMAP
	vSpecularIntensityMapUv = ( specularIntensityMapTransform * vec3( SPECULAR_INTENSITYMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_TRANSMISSIONMAP
	vTransmissionMapUv = ( transmissionMapTransform * vec3( TRANSMISSIONMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_THICKNESSMAP
	vThicknessMapUv = ( thicknessMapTransform * vec3( THICKNESSMAP_UV, 1 ) ).xy;
#endif`,Gx=`#if defined( USE_ENVMAP ) || defined( DISTANCE ) || defined ( USE_SHADOWMAP ) || defined ( USE_TRANSMISSION ) || NUM_SPOT_LIGHT_COORDS > 0
	vec4 worldPosition = vec4( transformed, 1.0 );
	#ifdef USE_BATCHING
		worldPosition = batchingMatrix * worldPosition;
	#endif
	#ifdef USE_INSTANCING
		worldPosition = instanceMatrix * worldPosition;
	#endif
	worldPosition = modelMatrix * worldPosition;
#endif`,Hx=`varying vec2 vUv;
uniform mat3 uvTransform;
void main() {
	vUv = ( uvTransform * vec3( uv, 1 ) ).xy;
	gl_Position = vec4( position.xy, 1.0, 1.0 );
}`,Wx=`uniform sampler2D t2D;
uniform float backgroundIntensity;
varying vec2 vUv;
void main() {
	vec4 texColor = texture2D( t2D, vUv );
	#ifdef DECODE_VIDEO_TEXTURE
		texColor = vec4( mix( pow( texColor.rgb * 0.9478672986 + vec3( 0.0521327014 ), vec3( 2.4 ) ), texColor.rgb * 0.0773993808, vec3( lessThanEqual( texColor.rgb, vec3( 0.04045 ) ) ) ), texColor.w );
	#endif
	texColor.rgb *= backgroundIntensity;
	gl_FragColor = texColor;
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
}`,$x=`varying vec3 vWorldDirection;
#include <common>
void main() {
	vWorldDirection = transformDirection( position, modelMatrix );
	#include <begin_vertex>
	#include <project_vertex>
	gl_Position.z = gl_Position.w;
}`,Xx=`uniform float backgroundBlurriness;
uniform float backgroundIntensity;
uniform mat3 backgroundRotation;
varying vec3 vWorldDirection;
#include <envmap_common_pars_fragment>
void main() {
	#ifdef ENVMAP_TYPE_PMREM
		vec4 texColor = textureLod( envMap, backgroundRotation * vWorldDirection, roughnessToMip( backgroundBlurriness ) );
	#else
		vec4 texColor = textureCube( envMap, backgroundRotation * vWorldDirection );
	#endif
	texColor.rgb *= backgroundIntensity;
	gl_FragColor = texColor;
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
}`,qx=`varying vec3 vWorldDirection;
#include <common>
void main() {
	vWorldDirection = transformDirection( position, modelMatrix );
	#include <begin_vertex>
	#include <project_vertex>
	gl_Position.z = gl_Position.w;
}`,Yx=`uniform samplerCube tCube;
uniform float tFlip;
uniform float opacity;
varying vec3 vWorldDirection;
void main() {
	vec4 texColor = textureCube( tCube, vec3( tFlip * vWorldDirection.x, vWorldDirection.yz ) );
	gl_FragColor = texColor;
	gl_FragColor.a *= opacity;
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
}`,Zx=`#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
varying vec2 vHighPrecisionZW;
void main() {
	#include <uv_vertex>
	#include <batching_vertex>
	#include <skinbase_vertex>
	#include <morphinstance_vertex>
	#ifdef USE_DISPLACEMENTMAP
		#include <beginnormal_vertex>
		#include <morphnormal_vertex>
		#include <skinnormal_vertex>
	#endif
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	vHighPrecisionZW = gl_Position.zw;
}`,Jx=`#if DEPTH_PACKING == 3200
	uniform float opacity;
#endif
#include <common>
#include <packing>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
varying vec2 vHighPrecisionZW;
void main() {
	vec4 diffuseColor = vec4( 1.0 );
	#include <clipping_planes_fragment>
	#if DEPTH_PACKING == 3200
		diffuseColor.a = opacity;
	#endif
	#include <map_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <logdepthbuf_fragment>
	#ifdef USE_REVERSED_DEPTH_BUFFER
		float fragCoordZ = vHighPrecisionZW[ 0 ] / vHighPrecisionZW[ 1 ];
	#else
		float fragCoordZ = 0.5 * vHighPrecisionZW[ 0 ] / vHighPrecisionZW[ 1 ] + 0.5;
	#endif
	#if DEPTH_PACKING == 3200
		gl_FragColor = vec4( vec3( 1.0 - fragCoordZ ), opacity );
	#elif DEPTH_PACKING == 3201
		gl_FragColor = packDepthToRGBA( fragCoordZ );
	#elif DEPTH_PACKING == 3202
		gl_FragColor = vec4( packDepthToRGB( fragCoordZ ), 1.0 );
	#elif DEPTH_PACKING == 3203
		gl_FragColor = vec4( packDepthToRG( fragCoordZ ), 0.0, 1.0 );
	#endif
}`,Kx=`#define DISTANCE
varying vec3 vWorldPosition;
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <batching_vertex>
	#include <skinbase_vertex>
	#include <morphinstance_vertex>
	#ifdef USE_DISPLACEMENTMAP
		#include <beginnormal_vertex>
		#include <morphnormal_vertex>
		#include <skinnormal_vertex>
	#endif
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <worldpos_vertex>
	#include <clipping_planes_vertex>
	vWorldPosition = worldPosition.xyz;
}`,jx=`#define DISTANCE
uniform vec3 referencePosition;
uniform float nearDistance;
uniform float farDistance;
varying vec3 vWorldPosition;
#include <common>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( 1.0 );
	#include <clipping_planes_fragment>
	#include <map_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	float dist = length( vWorldPosition - referencePosition );
	dist = ( dist - nearDistance ) / ( farDistance - nearDistance );
	dist = saturate( dist );
	gl_FragColor = vec4( dist, 0.0, 0.0, 1.0 );
}`,Qx=`varying vec3 vWorldDirection;
#include <common>
void main() {
	vWorldDirection = transformDirection( position, modelMatrix );
	#include <begin_vertex>
	#include <project_vertex>
}`,tv=`uniform sampler2D tEquirect;
varying vec3 vWorldDirection;
#include <common>
void main() {
	vec3 direction = normalize( vWorldDirection );
	vec2 sampleUV = equirectUv( direction );
	gl_FragColor = texture2D( tEquirect, sampleUV );
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
}`,ev=`uniform float scale;
attribute float lineDistance;
varying float vLineDistance;
#include <common>
#include <uv_pars_vertex>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <morphtarget_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	vLineDistance = scale * lineDistance;
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	#include <fog_vertex>
}`,nv=`uniform vec3 diffuse;
uniform float opacity;
uniform float dashSize;
uniform float totalSize;
varying float vLineDistance;
#include <common>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <fog_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	if ( mod( vLineDistance, totalSize ) > dashSize ) {
		discard;
	}
	vec3 outgoingLight = vec3( 0.0 );
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	outgoingLight = diffuseColor.rgb;
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
}`,iv=`#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <envmap_pars_vertex>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <batching_vertex>
	#if defined ( USE_ENVMAP ) || defined ( USE_SKINNING )
		#include <beginnormal_vertex>
		#include <morphnormal_vertex>
		#include <skinbase_vertex>
		#include <skinnormal_vertex>
		#include <defaultnormal_vertex>
	#endif
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	#include <worldpos_vertex>
	#include <envmap_vertex>
	#include <fog_vertex>
}`,sv=`uniform vec3 diffuse;
uniform float opacity;
#ifndef FLAT_SHADED
	varying vec3 vNormal;
#endif
#include <common>
#include <dithering_pars_fragment>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <aomap_pars_fragment>
#include <lightmap_pars_fragment>
#include <envmap_common_pars_fragment>
#include <envmap_pars_fragment>
#include <fog_pars_fragment>
#include <specularmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <specularmap_fragment>
	ReflectedLight reflectedLight = ReflectedLight( vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ) );
	#ifdef USE_LIGHTMAP
		vec4 lightMapTexel = texture2D( lightMap, vLightMapUv );
		reflectedLight.indirectDiffuse += lightMapTexel.rgb * lightMapIntensity * RECIPROCAL_PI;
	#else
		reflectedLight.indirectDiffuse += vec3( 1.0 );
	#endif
	#include <aomap_fragment>
	reflectedLight.indirectDiffuse *= diffuseColor.rgb;
	vec3 outgoingLight = reflectedLight.indirectDiffuse;
	#include <envmap_fragment>
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
	#include <dithering_fragment>
}`,rv=`#define LAMBERT
varying vec3 vViewPosition;
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <envmap_pars_vertex>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <normal_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <shadowmap_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <normal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	vViewPosition = - mvPosition.xyz;
	#include <worldpos_vertex>
	#include <envmap_vertex>
	#include <shadowmap_vertex>
	#include <fog_vertex>
}`,ov=`#define LAMBERT
uniform vec3 diffuse;
uniform vec3 emissive;
uniform float opacity;
#include <common>
#include <dithering_pars_fragment>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <aomap_pars_fragment>
#include <lightmap_pars_fragment>
#include <emissivemap_pars_fragment>
#include <envmap_common_pars_fragment>
#include <envmap_pars_fragment>
#include <envmap_physical_pars_fragment>
#include <fog_pars_fragment>
#include <bsdfs>
#include <lights_pars_begin>
#include <normal_pars_fragment>
#include <lights_lambert_pars_fragment>
#include <shadowmap_pars_fragment>
#include <bumpmap_pars_fragment>
#include <normalmap_pars_fragment>
#include <specularmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	ReflectedLight reflectedLight = ReflectedLight( vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ) );
	vec3 totalEmissiveRadiance = emissive;
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <specularmap_fragment>
	#include <normal_fragment_begin>
	#include <normal_fragment_maps>
	#include <emissivemap_fragment>
	#include <lights_lambert_fragment>
	#include <lights_fragment_begin>
	#include <lights_fragment_maps>
	#include <lights_fragment_end>
	#include <aomap_fragment>
	vec3 outgoingLight = reflectedLight.directDiffuse + reflectedLight.indirectDiffuse + totalEmissiveRadiance;
	#include <envmap_fragment>
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
	#include <dithering_fragment>
}`,av=`#define MATCAP
varying vec3 vViewPosition;
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <color_pars_vertex>
#include <displacementmap_pars_vertex>
#include <fog_pars_vertex>
#include <normal_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <normal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	#include <fog_vertex>
	vViewPosition = - mvPosition.xyz;
}`,lv=`#define MATCAP
uniform vec3 diffuse;
uniform float opacity;
uniform sampler2D matcap;
varying vec3 vViewPosition;
#include <common>
#include <dithering_pars_fragment>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <fog_pars_fragment>
#include <normal_pars_fragment>
#include <bumpmap_pars_fragment>
#include <normalmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <normal_fragment_begin>
	#include <normal_fragment_maps>
	vec3 viewDir = normalize( vViewPosition );
	vec3 x = normalize( vec3( viewDir.z, 0.0, - viewDir.x ) );
	vec3 y = cross( viewDir, x );
	vec2 uv = vec2( dot( x, normal ), dot( y, normal ) ) * 0.495 + 0.5;
	#ifdef USE_MATCAP
		vec4 matcapColor = texture2D( matcap, uv );
	#else
		vec4 matcapColor = vec4( vec3( mix( 0.2, 0.8, uv.y ) ), 1.0 );
	#endif
	vec3 outgoingLight = diffuseColor.rgb * matcapColor.rgb;
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
	#include <dithering_fragment>
}`,cv=`#define NORMAL
#if defined( FLAT_SHADED ) || defined( USE_BUMPMAP ) || defined( USE_NORMALMAP_TANGENTSPACE )
	varying vec3 vViewPosition;
#endif
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <normal_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphinstance_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <normal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
#if defined( FLAT_SHADED ) || defined( USE_BUMPMAP ) || defined( USE_NORMALMAP_TANGENTSPACE )
	vViewPosition = - mvPosition.xyz;
#endif
}`,hv=`#define NORMAL
uniform float opacity;
#if defined( FLAT_SHADED ) || defined( USE_BUMPMAP ) || defined( USE_NORMALMAP_TANGENTSPACE )
	varying vec3 vViewPosition;
#endif
#include <uv_pars_fragment>
#include <normal_pars_fragment>
#include <bumpmap_pars_fragment>
#include <normalmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( 0.0, 0.0, 0.0, opacity );
	#include <clipping_planes_fragment>
	#include <logdepthbuf_fragment>
	#include <normal_fragment_begin>
	#include <normal_fragment_maps>
	gl_FragColor = vec4( normalize( normal ) * 0.5 + 0.5, diffuseColor.a );
	#ifdef OPAQUE
		gl_FragColor.a = 1.0;
	#endif
}`,uv=`#define PHONG
varying vec3 vViewPosition;
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <envmap_pars_vertex>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <normal_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <shadowmap_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphcolor_vertex>
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphinstance_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <normal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	vViewPosition = - mvPosition.xyz;
	#include <worldpos_vertex>
	#include <envmap_vertex>
	#include <shadowmap_vertex>
	#include <fog_vertex>
}`,dv=`#define PHONG
uniform vec3 diffuse;
uniform vec3 emissive;
uniform vec3 specular;
uniform float shininess;
uniform float opacity;
#include <common>
#include <dithering_pars_fragment>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <aomap_pars_fragment>
#include <lightmap_pars_fragment>
#include <emissivemap_pars_fragment>
#include <envmap_common_pars_fragment>
#include <envmap_pars_fragment>
#include <envmap_physical_pars_fragment>
#include <fog_pars_fragment>
#include <bsdfs>
#include <lights_pars_begin>
#include <normal_pars_fragment>
#include <lights_phong_pars_fragment>
#include <shadowmap_pars_fragment>
#include <bumpmap_pars_fragment>
#include <normalmap_pars_fragment>
#include <specularmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	ReflectedLight reflectedLight = ReflectedLight( vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ) );
	vec3 totalEmissiveRadiance = emissive;
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <specularmap_fragment>
	#include <normal_fragment_begin>
	#include <normal_fragment_maps>
	#include <emissivemap_fragment>
	#include <lights_phong_fragment>
	#include <lights_fragment_begin>
	#include <lights_fragment_maps>
	#include <lights_fragment_end>
	#include <aomap_fragment>
	vec3 outgoingLight = reflectedLight.directDiffuse + reflectedLight.indirectDiffuse + reflectedLight.directSpecular + reflectedLight.indirectSpecular + totalEmissiveRadiance;
	#include <envmap_fragment>
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
	#include <dithering_fragment>
}`,fv=`#define STANDARD
varying vec3 vViewPosition;
#ifdef USE_TRANSMISSION
	varying vec3 vWorldPosition;
#endif
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <normal_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <shadowmap_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <normal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	vViewPosition = - mvPosition.xyz;
	#include <worldpos_vertex>
	#include <shadowmap_vertex>
	#include <fog_vertex>
#ifdef USE_TRANSMISSION
	vWorldPosition = worldPosition.xyz;
#endif
}`,pv=`#define STANDARD
#ifdef PHYSICAL
	#define IOR
	#define USE_SPECULAR
#endif
uniform vec3 diffuse;
uniform vec3 emissive;
uniform float roughness;
uniform float metalness;
uniform float opacity;
#ifdef IOR
	uniform float ior;
#endif
#ifdef USE_SPECULAR
	uniform float specularIntensity;
	uniform vec3 specularColor;
	#ifdef USE_SPECULAR_COLORMAP
		uniform sampler2D specularColorMap;
	#endif
	#ifdef USE_SPECULAR_INTENSITYMAP
		uniform sampler2D specularIntensityMap;
	#endif
#endif
#ifdef USE_CLEARCOAT
	uniform float clearcoat;
	uniform float clearcoatRoughness;
#endif
#ifdef USE_DIFFUSE_ROUGHNESS
	uniform float diffuseRoughness;
	#ifdef USE_DIFFUSE_ROUGHNESSMAP
		uniform sampler2D diffuseRoughnessMap;
	#endif
#endif
#ifdef USE_DISPERSION
	uniform float dispersion;
#endif
#ifdef USE_RETROREFLECTION
	uniform float retroreflectivity;
#endif
#ifdef USE_IRIDESCENCE
	uniform float iridescence;
	uniform float iridescenceIOR;
	uniform float iridescenceThicknessMinimum;
	uniform float iridescenceThicknessMaximum;
#endif
#ifdef USE_SHEEN
	uniform vec3 sheenColor;
	uniform float sheenRoughness;
	#ifdef USE_SHEEN_COLORMAP
		uniform sampler2D sheenColorMap;
	#endif
	#ifdef USE_SHEEN_ROUGHNESSMAP
		uniform sampler2D sheenRoughnessMap;
	#endif
#endif
#ifdef USE_ANISOTROPY
	uniform vec2 anisotropyVector;
	#ifdef USE_ANISOTROPYMAP
		uniform sampler2D anisotropyMap;
	#endif
#endif
varying vec3 vViewPosition;
#include <common>
#include <dithering_pars_fragment>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <aomap_pars_fragment>
#include <lightmap_pars_fragment>
#include <emissivemap_pars_fragment>
#include <iridescence_fragment>
#include <envmap_common_pars_fragment>
#include <envmap_physical_pars_fragment>
#include <fog_pars_fragment>
#include <lights_pars_begin>
#include <normal_pars_fragment>
#include <lights_physical_pars_fragment>
#include <transmission_pars_fragment>
#include <shadowmap_pars_fragment>
#include <bumpmap_pars_fragment>
#include <normalmap_pars_fragment>
#include <clearcoat_pars_fragment>
#include <iridescence_pars_fragment>
#include <roughnessmap_pars_fragment>
#include <metalnessmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	ReflectedLight reflectedLight = ReflectedLight( vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ) );
	vec3 totalEmissiveRadiance = emissive;
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <roughnessmap_fragment>
	#include <metalnessmap_fragment>
	#include <normal_fragment_begin>
	#include <normal_fragment_maps>
	#include <clearcoat_normal_fragment_begin>
	#include <clearcoat_normal_fragment_maps>
	#include <emissivemap_fragment>
	#include <lights_physical_fragment>
	#include <lights_fragment_begin>
	#include <lights_fragment_maps>
	#include <lights_fragment_end>
	#include <aomap_fragment>
	vec3 totalDiffuse = reflectedLight.directDiffuse + reflectedLight.indirectDiffuse;
	vec3 totalSpecular = reflectedLight.directSpecular + reflectedLight.indirectSpecular;
	#include <transmission_fragment>
	vec3 outgoingLight = totalDiffuse + totalSpecular + totalEmissiveRadiance;
	#ifdef USE_SHEEN
 
		outgoingLight = outgoingLight + sheenSpecularDirect + sheenSpecularIndirect;
 
 	#endif
	#ifdef USE_CLEARCOAT
		float dotNVcc = saturate( dot( geometryClearcoatNormal, geometryViewDir ) );
		vec3 Fcc = F_Schlick( material.clearcoatF0, material.clearcoatF90, dotNVcc );
		outgoingLight = outgoingLight * ( 1.0 - material.clearcoat * Fcc ) + ( clearcoatSpecularDirect + clearcoatSpecularIndirect ) * material.clearcoat;
	#endif
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
	#include <dithering_fragment>
}`,mv=`#define TOON
varying vec3 vViewPosition;
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <normal_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <shadowmap_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <normal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	vViewPosition = - mvPosition.xyz;
	#include <worldpos_vertex>
	#include <shadowmap_vertex>
	#include <fog_vertex>
}`,gv=`#define TOON
uniform vec3 diffuse;
uniform vec3 emissive;
uniform float opacity;
#include <common>
#include <dithering_pars_fragment>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <aomap_pars_fragment>
#include <lightmap_pars_fragment>
#include <emissivemap_pars_fragment>
#include <gradientmap_pars_fragment>
#include <fog_pars_fragment>
#include <bsdfs>
#include <lights_pars_begin>
#include <normal_pars_fragment>
#include <lights_toon_pars_fragment>
#include <shadowmap_pars_fragment>
#include <bumpmap_pars_fragment>
#include <normalmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	ReflectedLight reflectedLight = ReflectedLight( vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ) );
	vec3 totalEmissiveRadiance = emissive;
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <normal_fragment_begin>
	#include <normal_fragment_maps>
	#include <emissivemap_fragment>
	#include <lights_toon_fragment>
	#include <lights_fragment_begin>
	#include <lights_fragment_maps>
	#include <lights_fragment_end>
	#include <aomap_fragment>
	vec3 outgoingLight = reflectedLight.directDiffuse + reflectedLight.indirectDiffuse + totalEmissiveRadiance;
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
	#include <dithering_fragment>
}`,_v=`uniform float size;
uniform float scale;
#include <common>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <morphtarget_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
#ifdef USE_POINTS_UV
	varying vec2 vUv;
	uniform mat3 uvTransform;
#endif
void main() {
	#ifdef USE_POINTS_UV
		vUv = ( uvTransform * vec3( uv, 1 ) ).xy;
	#endif
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <project_vertex>
	gl_PointSize = size;
	#ifdef USE_SIZEATTENUATION
		bool isPerspective = isPerspectiveMatrix( projectionMatrix );
		if ( isPerspective ) gl_PointSize *= ( scale / - mvPosition.z );
	#endif
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	#include <worldpos_vertex>
	#include <fog_vertex>
}`,yv=`uniform vec3 diffuse;
uniform float opacity;
#include <common>
#include <color_pars_fragment>
#include <map_particle_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <fog_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	vec3 outgoingLight = vec3( 0.0 );
	#include <logdepthbuf_fragment>
	#include <map_particle_fragment>
	#include <color_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	outgoingLight = diffuseColor.rgb;
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
}`,xv=`#include <common>
#include <batching_pars_vertex>
#include <fog_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <shadowmap_pars_vertex>
void main() {
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphinstance_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <worldpos_vertex>
	#include <shadowmap_vertex>
	#include <fog_vertex>
}`,vv=`uniform vec3 color;
uniform float opacity;
#include <common>
#include <fog_pars_fragment>
#include <bsdfs>
#include <lights_pars_begin>
#include <logdepthbuf_pars_fragment>
#include <shadowmap_pars_fragment>
#include <shadowmask_pars_fragment>
void main() {
	#include <logdepthbuf_fragment>
	gl_FragColor = vec4( color, opacity * ( 1.0 - getShadowMask() ) );
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
}`,bv=`uniform float rotation;
uniform vec2 center;
#include <common>
#include <uv_pars_vertex>
#include <fog_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	vec4 mvPosition = modelViewMatrix[ 3 ];
	vec2 scale = vec2( length( modelMatrix[ 0 ].xyz ), length( modelMatrix[ 1 ].xyz ) );
	#ifndef USE_SIZEATTENUATION
		bool isPerspective = isPerspectiveMatrix( projectionMatrix );
		if ( isPerspective ) scale *= - mvPosition.z;
	#endif
	vec2 alignedPosition = ( position.xy - ( center - vec2( 0.5 ) ) ) * scale;
	vec2 rotatedPosition;
	rotatedPosition.x = cos( rotation ) * alignedPosition.x - sin( rotation ) * alignedPosition.y;
	rotatedPosition.y = sin( rotation ) * alignedPosition.x + cos( rotation ) * alignedPosition.y;
	mvPosition.xy += rotatedPosition;
	gl_Position = projectionMatrix * mvPosition;
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	#include <fog_vertex>
}`,Sv=`uniform vec3 diffuse;
uniform float opacity;
#include <common>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <fog_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	vec3 outgoingLight = vec3( 0.0 );
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	outgoingLight = diffuseColor.rgb;
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
}`,$t={alphahash_fragment:W_,alphahash_pars_fragment:$_,alphamap_fragment:X_,alphamap_pars_fragment:q_,alphatest_fragment:Y_,alphatest_pars_fragment:Z_,aomap_fragment:J_,aomap_pars_fragment:K_,batching_pars_vertex:j_,batching_vertex:Q_,begin_vertex:ty,beginnormal_vertex:ey,bsdfs:ny,iridescence_fragment:iy,bumpmap_pars_fragment:sy,clipping_planes_fragment:ry,clipping_planes_pars_fragment:oy,clipping_planes_pars_vertex:ay,clipping_planes_vertex:ly,color_fragment:cy,color_pars_fragment:hy,color_pars_vertex:uy,color_vertex:dy,common:fy,defaultnormal_vertex:py,displacementmap_pars_vertex:my,displacementmap_vertex:gy,emissivemap_fragment:_y,emissivemap_pars_fragment:yy,colorspace_fragment:xy,colorspace_pars_fragment:vy,envmap_fragment:by,envmap_common_pars_fragment:Sy,envmap_pars_fragment:My,envmap_pars_vertex:wy,envmap_physical_pars_fragment:Fy,envmap_vertex:Ay,fog_vertex:Ey,fog_pars_vertex:Ty,fog_fragment:Ry,fog_pars_fragment:Cy,gradientmap_pars_fragment:Py,lightmap_pars_fragment:Iy,lights_lambert_fragment:Ly,lights_lambert_pars_fragment:Dy,lights_pars_begin:Ny,lights_toon_fragment:Uy,lights_toon_pars_fragment:Oy,lights_phong_fragment:By,lights_phong_pars_fragment:ky,lights_physical_fragment:zy,lights_physical_pars_fragment:Vy,lights_fragment_begin:Gy,lights_fragment_maps:Hy,lights_fragment_end:Wy,lightprobes_pars_fragment:$y,logdepthbuf_fragment:Xy,logdepthbuf_pars_fragment:qy,logdepthbuf_pars_vertex:Yy,logdepthbuf_vertex:Zy,map_fragment:Jy,map_pars_fragment:Ky,map_particle_fragment:jy,map_particle_pars_fragment:Qy,metalnessmap_fragment:tx,metalnessmap_pars_fragment:ex,morphinstance_vertex:nx,morphcolor_vertex:ix,morphnormal_vertex:sx,morphtarget_pars_vertex:rx,morphtarget_vertex:ox,normal_fragment_begin:ax,normal_fragment_maps:lx,normal_pars_fragment:cx,normal_pars_vertex:hx,normal_vertex:ux,normalmap_pars_fragment:dx,clearcoat_normal_fragment_begin:fx,clearcoat_normal_fragment_maps:px,clearcoat_pars_fragment:mx,iridescence_pars_fragment:gx,opaque_fragment:_x,packing:yx,premultiplied_alpha_fragment:xx,project_vertex:vx,dithering_fragment:bx,dithering_pars_fragment:Sx,roughnessmap_fragment:Mx,roughnessmap_pars_fragment:wx,shadowmap_pars_fragment:Ax,shadowmap_pars_vertex:Ex,shadowmap_vertex:Tx,shadowmask_pars_fragment:Rx,skinbase_vertex:Cx,skinning_pars_vertex:Px,skinning_vertex:Ix,skinnormal_vertex:Lx,specularmap_fragment:Dx,specularmap_pars_fragment:Nx,tonemapping_fragment:Fx,tonemapping_pars_fragment:Ux,transmission_fragment:Ox,transmission_pars_fragment:Bx,uv_pars_fragment:kx,uv_pars_vertex:zx,uv_vertex:Vx,worldpos_vertex:Gx,background_vert:Hx,background_frag:Wx,backgroundCube_vert:$x,backgroundCube_frag:Xx,cube_vert:qx,cube_frag:Yx,depth_vert:Zx,depth_frag:Jx,distance_vert:Kx,distance_frag:jx,equirect_vert:Qx,equirect_frag:tv,linedashed_vert:ev,linedashed_frag:nv,meshbasic_vert:iv,meshbasic_frag:sv,meshlambert_vert:rv,meshlambert_frag:ov,meshmatcap_vert:av,meshmatcap_frag:lv,meshnormal_vert:cv,meshnormal_frag:hv,meshphong_vert:uv,meshphong_frag:dv,meshphysical_vert:fv,meshphysical_frag:pv,meshtoon_vert:mv,meshtoon_frag:gv,points_vert:_v,points_frag:yv,shadow_vert:xv,shadow_frag:vv,sprite_vert:bv,sprite_frag:Sv},_t={common:{diffuse:{value:new Kt(16777215)},opacity:{value:1},map:{value:null},mapTransform:{value:new Ut},alphaMap:{value:null},alphaMapTransform:{value:new Ut},alphaTest:{value:0}},specularmap:{specularMap:{value:null},specularMapTransform:{value:new Ut}},envmap:{envMap:{value:null},envMapRotation:{value:new Ut},reflectivity:{value:1},ior:{value:1.5},refractionRatio:{value:.98},dfgLUT:{value:null}},aomap:{aoMap:{value:null},aoMapIntensity:{value:1},aoMapTransform:{value:new Ut}},lightmap:{lightMap:{value:null},lightMapIntensity:{value:1},lightMapTransform:{value:new Ut}},bumpmap:{bumpMap:{value:null},bumpMapTransform:{value:new Ut},bumpScale:{value:1}},normalmap:{normalMap:{value:null},normalMapTransform:{value:new Ut},normalScale:{value:new St(1,1)}},displacementmap:{displacementMap:{value:null},displacementMapTransform:{value:new Ut},displacementScale:{value:1},displacementBias:{value:0}},emissivemap:{emissiveMap:{value:null},emissiveMapTransform:{value:new Ut}},metalnessmap:{metalnessMap:{value:null},metalnessMapTransform:{value:new Ut}},roughnessmap:{roughnessMap:{value:null},roughnessMapTransform:{value:new Ut}},gradientmap:{gradientMap:{value:null}},fog:{fogDensity:{value:25e-5},fogNear:{value:1},fogFar:{value:2e3},fogColor:{value:new Kt(16777215)}},lights:{ambientLightColor:{value:[]},lightProbe:{value:[]},sunLights:{value:[],properties:{direction:{},color:{}}},sunLightShadows:{value:[],properties:{shadowIntensity:1,shadowBias:{},shadowNormalBias:{},shadowRadius:{},shadowMapSize:{}}},sunShadowMatrix:{value:[]},sunShadowCascade:{value:[]},directionalLights:{value:[],properties:{direction:{},color:{}}},directionalLightShadows:{value:[],properties:{shadowIntensity:1,shadowBias:{},shadowNormalBias:{},shadowRadius:{},shadowMapSize:{}}},directionalShadowMatrix:{value:[]},spotLights:{value:[],properties:{color:{},position:{},direction:{},distance:{},coneCos:{},penumbraCos:{},decay:{}}},spotLightShadows:{value:[],properties:{shadowIntensity:1,shadowBias:{},shadowNormalBias:{},shadowRadius:{},shadowMapSize:{}}},spotLightMap:{value:[]},spotLightMatrix:{value:[]},pointLights:{value:[],properties:{color:{},position:{},decay:{},distance:{}}},pointLightShadows:{value:[],properties:{shadowIntensity:1,shadowBias:{},shadowNormalBias:{},shadowRadius:{},shadowMapSize:{},shadowCameraNear:{},shadowCameraFar:{}}},pointShadowMatrix:{value:[]},hemisphereLights:{value:[],properties:{direction:{},skyColor:{},groundColor:{}}},rectAreaLights:{value:[],properties:{color:{},position:{},width:{},height:{}}},ltc_1:{value:null},ltc_2:{value:null},probesSH:{value:[]},probesMin:{value:[]},probesMax:{value:[]},probesResolution:{value:[]}},points:{diffuse:{value:new Kt(16777215)},opacity:{value:1},size:{value:1},scale:{value:1},map:{value:null},alphaMap:{value:null},alphaMapTransform:{value:new Ut},alphaTest:{value:0},uvTransform:{value:new Ut}},sprite:{diffuse:{value:new Kt(16777215)},opacity:{value:1},center:{value:new St(.5,.5)},rotation:{value:0},map:{value:null},mapTransform:{value:new Ut},alphaMap:{value:null},alphaMapTransform:{value:new Ut},alphaTest:{value:0}}},xi={basic:{uniforms:dn([_t.common,_t.specularmap,_t.envmap,_t.aomap,_t.lightmap,_t.fog]),vertexShader:$t.meshbasic_vert,fragmentShader:$t.meshbasic_frag},lambert:{uniforms:dn([_t.common,_t.specularmap,_t.envmap,_t.aomap,_t.lightmap,_t.emissivemap,_t.bumpmap,_t.normalmap,_t.displacementmap,_t.fog,_t.lights,{emissive:{value:new Kt(0)},envMapIntensity:{value:1}}]),vertexShader:$t.meshlambert_vert,fragmentShader:$t.meshlambert_frag},phong:{uniforms:dn([_t.common,_t.specularmap,_t.envmap,_t.aomap,_t.lightmap,_t.emissivemap,_t.bumpmap,_t.normalmap,_t.displacementmap,_t.fog,_t.lights,{emissive:{value:new Kt(0)},specular:{value:new Kt(1118481)},shininess:{value:30},envMapIntensity:{value:1}}]),vertexShader:$t.meshphong_vert,fragmentShader:$t.meshphong_frag},standard:{uniforms:dn([_t.common,_t.envmap,_t.aomap,_t.lightmap,_t.emissivemap,_t.bumpmap,_t.normalmap,_t.displacementmap,_t.roughnessmap,_t.metalnessmap,_t.fog,_t.lights,{emissive:{value:new Kt(0)},roughness:{value:1},metalness:{value:0},envMapIntensity:{value:1}}]),vertexShader:$t.meshphysical_vert,fragmentShader:$t.meshphysical_frag},toon:{uniforms:dn([_t.common,_t.aomap,_t.lightmap,_t.emissivemap,_t.bumpmap,_t.normalmap,_t.displacementmap,_t.gradientmap,_t.fog,_t.lights,{emissive:{value:new Kt(0)}}]),vertexShader:$t.meshtoon_vert,fragmentShader:$t.meshtoon_frag},matcap:{uniforms:dn([_t.common,_t.bumpmap,_t.normalmap,_t.displacementmap,_t.fog,{matcap:{value:null}}]),vertexShader:$t.meshmatcap_vert,fragmentShader:$t.meshmatcap_frag},points:{uniforms:dn([_t.points,_t.fog]),vertexShader:$t.points_vert,fragmentShader:$t.points_frag},dashed:{uniforms:dn([_t.common,_t.fog,{scale:{value:1},dashSize:{value:1},totalSize:{value:2}}]),vertexShader:$t.linedashed_vert,fragmentShader:$t.linedashed_frag},depth:{uniforms:dn([_t.common,_t.displacementmap]),vertexShader:$t.depth_vert,fragmentShader:$t.depth_frag},normal:{uniforms:dn([_t.common,_t.bumpmap,_t.normalmap,_t.displacementmap,{opacity:{value:1}}]),vertexShader:$t.meshnormal_vert,fragmentShader:$t.meshnormal_frag},sprite:{uniforms:dn([_t.sprite,_t.fog]),vertexShader:$t.sprite_vert,fragmentShader:$t.sprite_frag},background:{uniforms:{uvTransform:{value:new Ut},t2D:{value:null},backgroundIntensity:{value:1}},vertexShader:$t.background_vert,fragmentShader:$t.background_frag},backgroundCube:{uniforms:{envMap:{value:null},backgroundBlurriness:{value:0},backgroundIntensity:{value:1},backgroundRotation:{value:new Ut}},vertexShader:$t.backgroundCube_vert,fragmentShader:$t.backgroundCube_frag},cube:{uniforms:{tCube:{value:null},tFlip:{value:-1},opacity:{value:1}},vertexShader:$t.cube_vert,fragmentShader:$t.cube_frag},equirect:{uniforms:{tEquirect:{value:null}},vertexShader:$t.equirect_vert,fragmentShader:$t.equirect_frag},distance:{uniforms:dn([_t.common,_t.displacementmap,{referencePosition:{value:new C},nearDistance:{value:1},farDistance:{value:1e3}}]),vertexShader:$t.distance_vert,fragmentShader:$t.distance_frag},shadow:{uniforms:dn([_t.lights,_t.fog,{color:{value:new Kt(0)},opacity:{value:1}}]),vertexShader:$t.shadow_vert,fragmentShader:$t.shadow_frag}};xi.physical={uniforms:dn([xi.standard.uniforms,{clearcoat:{value:0},clearcoatMap:{value:null},clearcoatMapTransform:{value:new Ut},clearcoatNormalMap:{value:null},clearcoatNormalMapTransform:{value:new Ut},clearcoatNormalScale:{value:new St(1,1)},clearcoatRoughness:{value:0},clearcoatRoughnessMap:{value:null},clearcoatRoughnessMapTransform:{value:new Ut},diffuseRoughness:{value:0},diffuseRoughnessMap:{value:null},diffuseRoughnessMapTransform:{value:new Ut},dispersion:{value:0},retroreflectivity:{value:0},iridescence:{value:0},iridescenceMap:{value:null},iridescenceMapTransform:{value:new Ut},iridescenceIOR:{value:1.3},iridescenceThicknessMinimum:{value:100},iridescenceThicknessMaximum:{value:400},iridescenceThicknessMap:{value:null},iridescenceThicknessMapTransform:{value:new Ut},sheen:{value:0},sheenColor:{value:new Kt(0)},sheenColorMap:{value:null},sheenColorMapTransform:{value:new Ut},sheenRoughness:{value:1},sheenRoughnessMap:{value:null},sheenRoughnessMapTransform:{value:new Ut},transmission:{value:0},transmissionMap:{value:null},transmissionMapTransform:{value:new Ut},transmissionSamplerSize:{value:new St},transmissionSamplerMap:{value:null},thickness:{value:0},thicknessMap:{value:null},thicknessMapTransform:{value:new Ut},attenuationDistance:{value:0},attenuationColor:{value:new Kt(0)},specularColor:{value:new Kt(1,1,1)},specularColorMap:{value:null},specularColorMapTransform:{value:new Ut},specularIntensity:{value:1},specularIntensityMap:{value:null},specularIntensityMapTransform:{value:new Ut},anisotropyVector:{value:new St},anisotropyMap:{value:null},anisotropyMapTransform:{value:new Ut}}]),vertexShader:$t.meshphysical_vert,fragmentShader:$t.meshphysical_frag};var Ec={r:0,b:0,g:0},Mv=new Pt,Vm=new Ut;Vm.set(-1,0,0,0,1,0,0,0,1);function wv(i,t,e,n,s,r){let o=new Kt(0),a=s===!0?0:1,l,c,h=null,u=0,d=null;function f(y){let b=y.isScene===!0?y.background:null;if(b&&b.isTexture){let v=y.backgroundBlurriness>0;b=t.get(b,v)}return b}function p(y){let b=!1,v=f(y);v===null?m(o,a):v&&v.isColor&&(m(v,1),b=!0);let M=i.xr.getEnvironmentBlendMode();M==="additive"?e.buffers.color.setClear(0,0,0,1,r):M==="alpha-blend"&&e.buffers.color.setClear(0,0,0,0,r),(i.autoClear||b)&&(e.buffers.depth.setTest(!0),e.buffers.depth.setMask(!0),e.buffers.color.setMask(!0),i.clear(i.autoClearColor,i.autoClearDepth,i.autoClearStencil))}function _(y,b){let v=f(b);v&&v.isCubeTexture?(c===void 0&&(c=new Ee(new Ui(1,1,1),new Ie({name:"BackgroundCubeMaterial",uniforms:Os(xi.backgroundCube.uniforms),vertexShader:xi.backgroundCube.vertexShader,fragmentShader:xi.backgroundCube.fragmentShader,side:nn,depthTest:!1,depthWrite:!1,fog:!1,allowOverride:!1})),c.geometry.deleteAttribute("normal"),c.geometry.deleteAttribute("uv"),c.onBeforeRender=function(M,A,x){this.matrixWorld.copyPosition(x.matrixWorld)},Object.defineProperty(c.material,"envMap",{get:function(){return this.uniforms.envMap.value}}),n.update(c)),c.material.uniforms.envMap.value=v,c.material.uniforms.backgroundBlurriness.value=b.backgroundBlurriness,c.material.uniforms.backgroundIntensity.value=b.backgroundIntensity,c.material.uniforms.backgroundRotation.value.setFromMatrix4(Mv.makeRotationFromEuler(b.backgroundRotation)).transpose(),v.isRenderTargetTexture===!1&&c.material.uniforms.backgroundRotation.value.premultiply(Vm),c.material.toneMapped=Jt.getTransfer(v.colorSpace)!==oe,(h!==v||u!==v.version||d!==i.toneMapping)&&(c.material.needsUpdate=!0,h=v,u=v.version,d=i.toneMapping),c.layers.enableAll(),y.unshift(c,c.geometry,c.material,0,0,null)):v&&v.isTexture&&(l===void 0&&(l=new Ee(new Eo(2,2),new Ie({name:"BackgroundMaterial",uniforms:Os(xi.background.uniforms),vertexShader:xi.background.vertexShader,fragmentShader:xi.background.fragmentShader,side:oi,depthTest:!1,depthWrite:!1,fog:!1,allowOverride:!1})),l.geometry.deleteAttribute("normal"),Object.defineProperty(l.material,"map",{get:function(){return this.uniforms.t2D.value}}),n.update(l)),l.material.uniforms.t2D.value=v,l.material.uniforms.backgroundIntensity.value=b.backgroundIntensity,l.material.toneMapped=Jt.getTransfer(v.colorSpace)!==oe,v.matrixAutoUpdate===!0&&v.updateMatrix(),l.material.uniforms.uvTransform.value.copy(v.matrix),(h!==v||u!==v.version||d!==i.toneMapping)&&(l.material.needsUpdate=!0,h=v,u=v.version,d=i.toneMapping),l.layers.enableAll(),y.unshift(l,l.geometry,l.material,0,0,null))}function m(y,b){y.getRGB(Ec,qu(i)),e.buffers.color.setClear(Ec.r,Ec.g,Ec.b,b,r)}function g(){c!==void 0&&(c.geometry.dispose(),c.material.dispose(),c=void 0),l!==void 0&&(l.geometry.dispose(),l.material.dispose(),l=void 0)}return{getClearColor:function(){return o},setClearColor:function(y,b=1){o.set(y),a=b,m(o,a)},getClearAlpha:function(){return a},setClearAlpha:function(y){a=y,m(o,a)},render:p,addToRenderList:_,dispose:g}}function Av(i,t){let e=i.getParameter(i.MAX_VERTEX_ATTRIBS),n={},s=d(null),r=s,o=!1;function a(N,P,U,L,k){let z=!1,W=u(N,L,U,P);r!==W&&(r=W,c(r.object)),z=f(N,L,U,k),z&&p(N,L,U,k),k!==null&&t.update(k,i.ELEMENT_ARRAY_BUFFER),(z||o)&&(o=!1,v(N,P,U,L),k!==null&&i.bindBuffer(i.ELEMENT_ARRAY_BUFFER,t.get(k).buffer))}function l(){return i.createVertexArray()}function c(N){return i.bindVertexArray(N)}function h(N){return i.deleteVertexArray(N)}function u(N,P,U,L){let k=L.wireframe===!0,z=n[P.id];z===void 0&&(z={},n[P.id]=z);let W=N.isInstancedMesh===!0?N.id:0,et=z[W];et===void 0&&(et={},z[W]=et);let X=et[U.id];X===void 0&&(X={},et[U.id]=X);let Q=X[k];return Q===void 0&&(Q=d(l()),X[k]=Q),Q}function d(N){let P=[],U=[],L=[];for(let k=0;k<e;k++)P[k]=0,U[k]=0,L[k]=0;return{geometry:null,program:null,wireframe:!1,newAttributes:P,enabledAttributes:U,attributeDivisors:L,object:N,attributes:{},index:null}}function f(N,P,U,L){let k=r.attributes,z=P.attributes,W=0,et=U.getAttributes();for(let X in et)if(et[X].location>=0){let tt=k[X],vt=z[X];if(vt===void 0&&(X==="instanceMatrix"&&N.instanceMatrix&&(vt=N.instanceMatrix),X==="instanceColor"&&N.instanceColor&&(vt=N.instanceColor)),tt===void 0||tt.attribute!==vt||vt&&tt.data!==vt.data)return!0;W++}return r.attributesNum!==W||r.index!==L}function p(N,P,U,L){let k={},z=P.attributes,W=0,et=U.getAttributes();for(let X in et)if(et[X].location>=0){let tt=z[X];tt===void 0&&(X==="instanceMatrix"&&N.instanceMatrix&&(tt=N.instanceMatrix),X==="instanceColor"&&N.instanceColor&&(tt=N.instanceColor));let vt={};vt.attribute=tt,tt&&tt.data&&(vt.data=tt.data),k[X]=vt,W++}r.attributes=k,r.attributesNum=W,r.index=L}function _(){let N=r.newAttributes;for(let P=0,U=N.length;P<U;P++)N[P]=0}function m(N){g(N,0)}function g(N,P){let U=r.newAttributes,L=r.enabledAttributes,k=r.attributeDivisors;U[N]=1,L[N]===0&&(i.enableVertexAttribArray(N),L[N]=1),k[N]!==P&&(i.vertexAttribDivisor(N,P),k[N]=P)}function y(){let N=r.newAttributes,P=r.enabledAttributes;for(let U=0,L=P.length;U<L;U++)P[U]!==N[U]&&(i.disableVertexAttribArray(U),P[U]=0)}function b(N,P,U,L,k,z,W){W===!0?i.vertexAttribIPointer(N,P,U,k,z):i.vertexAttribPointer(N,P,U,L,k,z)}function v(N,P,U,L){_();let k=L.attributes,z=U.getAttributes(),W=P.defaultAttributeValues;for(let et in z){let X=z[et];if(X.location>=0){let Q=k[et];if(Q===void 0&&(et==="instanceMatrix"&&N.instanceMatrix&&(Q=N.instanceMatrix),et==="instanceColor"&&N.instanceColor&&(Q=N.instanceColor)),Q!==void 0){let tt=Q.normalized,vt=Q.itemSize,Ft=t.get(Q);if(Ft===void 0)continue;let J=Ft.buffer,ut=Ft.type,xt=Ft.bytesPerElement,Ct=ut===i.INT||ut===i.UNSIGNED_INT||Q.gpuType===Hl;if(Q.isInterleavedBufferAttribute){let mt=Q.data,Bt=mt.isInterleavedBuffer===!0?mt.stride:mt.itemSize,Ce=Q.offset;if(mt.isInstancedInterleavedBuffer||mt.isInstancedBufferAttribute){for(let Lt=0;Lt<X.locationSize;Lt++)g(X.location+Lt,mt.meshPerAttribute);N.isInstancedMesh!==!0&&L._maxInstanceCount===void 0&&(L._maxInstanceCount=mt.meshPerAttribute*mt.count)}else for(let Lt=0;Lt<X.locationSize;Lt++)m(X.location+Lt);i.bindBuffer(i.ARRAY_BUFFER,J);for(let Lt=0;Lt<X.locationSize;Lt++)b(X.location+Lt,vt/X.locationSize,ut,tt,Bt*xt,(Ce+vt/X.locationSize*Lt)*xt,Ct)}else{if(Q.isInstancedBufferAttribute){for(let mt=0;mt<X.locationSize;mt++)g(X.location+mt,Q.meshPerAttribute);N.isInstancedMesh!==!0&&L._maxInstanceCount===void 0&&(L._maxInstanceCount=Q.meshPerAttribute*Q.count)}else for(let mt=0;mt<X.locationSize;mt++)m(X.location+mt);i.bindBuffer(i.ARRAY_BUFFER,J);for(let mt=0;mt<X.locationSize;mt++)b(X.location+mt,vt/X.locationSize,ut,tt,vt*xt,vt/X.locationSize*mt*xt,Ct)}}else if(W!==void 0){let tt=W[et];if(tt!==void 0)switch(tt.length){case 2:i.vertexAttrib2fv(X.location,tt);break;case 3:i.vertexAttrib3fv(X.location,tt);break;case 4:i.vertexAttrib4fv(X.location,tt);break;default:i.vertexAttrib1fv(X.location,tt)}}}}y()}function M(){D();for(let N in n){let P=n[N];for(let U in P){let L=P[U];for(let k in L){let z=L[k];for(let W in z)h(z[W].object),delete z[W];delete L[k]}}delete n[N]}}function A(N){if(n[N.id]===void 0)return;let P=n[N.id];for(let U in P){let L=P[U];for(let k in L){let z=L[k];for(let W in z)h(z[W].object),delete z[W];delete L[k]}}delete n[N.id]}function x(N){for(let P in n){let U=n[P];for(let L in U){let k=U[L];if(k[N.id]===void 0)continue;let z=k[N.id];for(let W in z)h(z[W].object),delete z[W];delete k[N.id]}}}function w(N){for(let P in n){let U=n[P],L=N.isInstancedMesh===!0?N.id:0,k=U[L];if(k!==void 0){for(let z in k){let W=k[z];for(let et in W)h(W[et].object),delete W[et];delete k[z]}delete U[L],Object.keys(U).length===0&&delete n[P]}}}function D(){R(),o=!0,r!==s&&(r=s,c(r.object))}function R(){s.geometry=null,s.program=null,s.wireframe=!1}return{setup:a,reset:D,resetDefaultState:R,dispose:M,releaseStatesOfGeometry:A,releaseStatesOfObject:w,releaseStatesOfProgram:x,initAttributes:_,enableAttribute:m,disableUnusedAttributes:y}}function Ev(i,t,e){let n;function s(l){n=l}function r(l,c){i.drawArrays(n,l,c),e.update(c,n,1)}function o(l,c,h){h!==0&&(i.drawArraysInstanced(n,l,c,h),e.update(c,n,h))}function a(l,c,h){if(h===0)return;t.get("WEBGL_multi_draw").multiDrawArraysWEBGL(n,l,0,c,0,h);let d=0;for(let f=0;f<h;f++)d+=c[f];e.update(d,n,1)}this.setMode=s,this.render=r,this.renderInstances=o,this.renderMultiDraw=a}function Tv(i,t,e,n){let s;function r(){if(s!==void 0)return s;if(t.has("EXT_texture_filter_anisotropic")===!0){let x=t.get("EXT_texture_filter_anisotropic");s=i.getParameter(x.MAX_TEXTURE_MAX_ANISOTROPY_EXT)}else s=0;return s}function o(x){return!(x!==sn&&n.convert(x)!==i.getParameter(i.IMPLEMENTATION_COLOR_READ_FORMAT))}function a(x){let w=x===li&&(t.has("EXT_color_buffer_half_float")||t.has("EXT_color_buffer_float"));return!(x!==Bn&&x!==Rn&&!w&&n.convert(x)!==i.getParameter(i.IMPLEMENTATION_COLOR_READ_TYPE))}function l(x){if(x==="highp"){if(i.getShaderPrecisionFormat(i.VERTEX_SHADER,i.HIGH_FLOAT).precision>0&&i.getShaderPrecisionFormat(i.FRAGMENT_SHADER,i.HIGH_FLOAT).precision>0)return"highp";x="mediump"}return x==="mediump"&&i.getShaderPrecisionFormat(i.VERTEX_SHADER,i.MEDIUM_FLOAT).precision>0&&i.getShaderPrecisionFormat(i.FRAGMENT_SHADER,i.MEDIUM_FLOAT).precision>0?"mediump":"lowp"}let c=e.precision!==void 0?e.precision:"highp",h=l(c);h!==c&&(It("WebGLRenderer:",c,"not supported, using",h,"instead."),c=h);let u=e.reversedDepthBuffer===!0&&t.has("EXT_clip_control"),d=e.logarithmicDepthBuffer===!0&&u===!1;e.reversedDepthBuffer===!0&&u===!1&&It("WebGLRenderer: Unable to use reversed depth buffer due to missing EXT_clip_control extension. Fallback to default depth buffer."),e.logarithmicDepthBuffer===!0&&u===!0&&It("WebGLRenderer: Logarithmic depth buffer is ignored when reversed depth buffer is enabled.");let f=i.getParameter(i.MAX_TEXTURE_IMAGE_UNITS),p=i.getParameter(i.MAX_VERTEX_TEXTURE_IMAGE_UNITS),_=i.getParameter(i.MAX_TEXTURE_SIZE),m=i.getParameter(i.MAX_CUBE_MAP_TEXTURE_SIZE),g=i.getParameter(i.MAX_VERTEX_ATTRIBS),y=i.getParameter(i.MAX_VERTEX_UNIFORM_VECTORS),b=i.getParameter(i.MAX_VARYING_VECTORS),v=i.getParameter(i.MAX_FRAGMENT_UNIFORM_VECTORS),M=i.getParameter(i.MAX_SAMPLES),A=i.getParameter(i.SAMPLES);return{isWebGL2:!0,getMaxAnisotropy:r,getMaxPrecision:l,textureFormatReadable:o,textureTypeReadable:a,precision:c,logarithmicDepthBuffer:d,reversedDepthBuffer:u,maxTextures:f,maxVertexTextures:p,maxTextureSize:_,maxCubemapSize:m,maxAttributes:g,maxVertexUniforms:y,maxVaryings:b,maxFragmentUniforms:v,maxSamples:M,samples:A}}function Rv(i){let t=this,e=null,n=0,s=!1,r=!1,o=new tn,a=new Ut,l={value:null,needsUpdate:!1};this.uniform=l,this.numPlanes=0,this.numIntersection=0,this.init=function(u,d){let f=u.length!==0||d||n!==0||s;return s=d,n=u.length,f},this.beginShadows=function(){r=!0,h(null)},this.endShadows=function(){r=!1},this.setGlobalState=function(u,d){e=h(u,d,0)},this.setState=function(u,d,f){let p=u.clippingPlanes,_=u.clipIntersection,m=u.clipShadows,g=i.get(u);if(!s||p===null||p.length===0||r&&!m)r?h(null):c();else{let y=r?0:n,b=y*4,v=g.clippingState||null;l.value=v,v=h(p,d,b,f);for(let M=0;M!==b;++M)v[M]=e[M];g.clippingState=v,this.numIntersection=_?this.numPlanes:0,this.numPlanes+=y}};function c(){l.value!==e&&(l.value=e,l.needsUpdate=n>0),t.numPlanes=n,t.numIntersection=0}function h(u,d,f,p){let _=u!==null?u.length:0,m=null;if(_!==0){if(m=l.value,p!==!0||m===null){let g=f+_*4,y=d.matrixWorldInverse;a.getNormalMatrix(y),(m===null||m.length<g)&&(m=new Float32Array(g));for(let b=0,v=f;b!==_;++b,v+=4)o.copy(u[b]).applyMatrix4(y,a),o.normal.toArray(m,v),m[v+3]=o.constant}l.value=m,l.needsUpdate=!0}return t.numPlanes=_,t.numIntersection=0,m}}var Go=class extends Un{constructor(t=1,e={}){super(t,t,e),this.isWebGLCubeRenderTarget=!0;let n={width:t,height:t,depth:1},s=[n,n,n,n,n,n];this.texture=new So(s),this._setTextureOptions(e),this.texture.isRenderTargetTexture=!0}fromEquirectangularTexture(t,e){this.texture.type=e.type,this.texture.colorSpace=e.colorSpace,this.texture.generateMipmaps=e.generateMipmaps,this.texture.minFilter=e.minFilter,this.texture.magFilter=e.magFilter;let n={uniforms:{tEquirect:{value:null}},vertexShader:`

				varying vec3 vWorldDirection;

				vec3 transformDirection( in vec3 dir, in mat4 matrix ) {

					return normalize( ( matrix * vec4( dir, 0.0 ) ).xyz );

				}

				void main() {

					vWorldDirection = transformDirection( position, modelMatrix );

					#include <begin_vertex>
					#include <project_vertex>

				}
			`,fragmentShader:`

				uniform sampler2D tEquirect;

				varying vec3 vWorldDirection;

				#include <common>

				void main() {

					vec3 direction = normalize( vWorldDirection );

					vec2 sampleUV = equirectUv( direction );

					gl_FragColor = texture2D( tEquirect, sampleUV );

				}
			`},s=new Ui(5,5,5),r=new Ie({name:"CubemapFromEquirect",uniforms:Os(n.uniforms),vertexShader:n.vertexShader,fragmentShader:n.fragmentShader,side:nn,blending:Ds});r.uniforms.tEquirect.value=e;let o=new Ee(s,r),a=e.minFilter;return e.minFilter===Vi&&(e.minFilter=yn),new vr(1,10,this).update(t,o),e.minFilter=a,o.geometry.dispose(),o.material.dispose(),this}clear(t,e=!0,n=!0,s=!0){let r=t.getRenderTarget();for(let o=0;o<6;o++)t.setRenderTarget(this,o),t.clear(e,n,s);t.setRenderTarget(r)}},xm=256,Cv=3,Pv=20,Gm=256,Hm=16,Iv=3,Lv=new C,Dv=new Kt,Rc=class i{constructor(t){this._renderer=t,this._cubeSize=0,this._sourceTarget=null,this._cubeCamera=new vr(1,10,null),this._boxMesh=new Ee(new Ui(5,5,5),null),this._cubemapMaterial=null,this._equirectMaterial=null,this._blurMaterial=null,this._ggxMaterial=null,this._integrationMaterial=null}fromScene(t,e=0,n=.1,s=100,r={}){let{size:o=256,position:a=Lv}=r,l=this._renderer;this._setSize(o);let c=this._allocateTarget(),h=this._getSourceTarget(!0);e>0&&(h.texture.mipmapsAutoUpdate=!1);let u=l.autoClear,d=l.autoClearColor,f=l.autoClearDepth,p=l.autoClearStencil,_=t.background;l.autoClear=!0,l.autoClearColor=!0,l.autoClearDepth=!0,l.autoClearStencil=!0,_===null&&(t.background=l.getClearColor(Dv));let m=new vr(n,s,h);return m.position.copy(a),m.update(l,t),l.autoClear=u,l.autoClearColor=d,l.autoClearDepth=f,l.autoClearStencil=p,t.background=_,e>0&&(h.texture.mipmapsAutoUpdate=!0,this._blur(c,e)),this._applyPMREM(c),c}fromEquirectangular(t,e=null){return this._fromTexture(t,e)}fromCubemap(t,e=null){return this._fromTexture(t,e)}compileCubemapShader(){this._cubemapMaterial===null&&(this._cubemapMaterial=Sm(),this._compileMaterial(this._cubemapMaterial))}compileEquirectangularShader(){this._equirectMaterial===null&&(this._equirectMaterial=bm(),this._compileMaterial(this._equirectMaterial))}dispose(){this._sourceTarget!==null&&this._sourceTarget.dispose(),this._cubemapMaterial!==null&&this._cubemapMaterial.dispose(),this._equirectMaterial!==null&&this._equirectMaterial.dispose(),this._blurMaterial!==null&&this._blurMaterial.dispose(),this._ggxMaterial!==null&&this._ggxMaterial.dispose(),this._integrationMaterial!==null&&this._integrationMaterial.dispose(),this._boxMesh.geometry.dispose()}static lodToRoughness(t,e){return e>0?1-Math.sqrt(1-t/e):0}_setSize(t){this._cubeSize=Math.max(xm,Hu(t))}_fromTexture(t,e){t.mapping===Fs||t.mapping===wr?this._setSize(t.image.length===0?xm:t.image[0].width||t.image[0].image.width):this._setSize(t.image.width/4);let n=e||this._allocateTarget();return this._textureToCubemap(t),this._applyPMREM(n),n}_allocateTarget(){let t=this._cubeSize,e=vm(t,!1,!1),n=Math.log2(t)-Cv;for(let s=0;s<=n;s++)e.texture.mipmaps.push({width:t>>s,height:t>>s});return e.texture.name="PMREM",e.texture.isPMREMTexture=!0,e}_getSourceTarget(t=!1){let e=this._cubeSize,n=this._sourceTarget;return(n===null||n.width!==e||t&&n.depthBuffer===!1)&&(n!==null&&n.dispose(),this._sourceTarget=vm(e,!0,t)),this._sourceTarget}_compileMaterial(t){this._boxMesh.material=t,this._renderer.compile(this._boxMesh,this._cubeCamera.children[0])}_renderCube(t,e,n){let s=this._boxMesh,r=this._cubeCamera;s.material=n,r.renderTarget=t,r.activeMipmapLevel=e;let o=t.width>>e;t.viewport.set(0,0,o,o),r.update(this._renderer,s),t.viewport.set(0,0,t.width,t.height)}_textureToCubemap(t){let e;t.mapping===Fs||t.mapping===wr?(this._cubemapMaterial===null&&(this._cubemapMaterial=Sm()),e=this._cubemapMaterial,e.uniforms.flipEnvMap.value=t.isRenderTargetTexture===!1?-1:1):(this._equirectMaterial===null&&(this._equirectMaterial=bm()),e=this._equirectMaterial),e.uniforms.envMap.value=t,this._renderCube(this._getSourceTarget(),0,e)}_applyPMREM(t){this._ggxMaterial===null&&(this._ggxMaterial=Nv(),this._integrationMaterial=Fv());let e=this._cubeSize,n=t.texture.mipmaps.length-1,s=this._ggxMaterial.uniforms;s.envMap.value=this._sourceTarget.texture;let r=this._integrationMaterial.uniforms;r.envMap.value=this._sourceTarget.texture,r.sourceLod.value=Math.log2(e/Hm);for(let o=0;o<=n;o++){let a=i.lodToRoughness(o,n);if(o>n-Iv)r.roughness.value=a,this._renderCube(t,o,this._integrationMaterial);else{let l=a>0?Math.log2(e)+.5*Math.log2(6/(Gm*Math.pow(a,4)))+.5:0;s.roughness.value=a,s.lodBias.value=l,this._renderCube(t,o,this._ggxMaterial)}}}_blur(t,e){this._blurMaterial===null&&(this._blurMaterial=Uv());let n=this._blurMaterial,s=n.uniforms,r=this._sourceTarget;s.sigma.value=Math.min(e,Math.PI)/Math.SQRT2,s.envMap.value=r.texture,this._renderCube(t,0,n),s.envMap.value=t.texture,this._renderCube(r,0,n)}};function vm(i,t,e){return new Go(i,{minFilter:Vi,generateMipmaps:t,type:li,colorSpace:ho,depthBuffer:e})}function Ho(i,t,e){return new Ie({name:i,uniforms:t,vertexShader:$t.cube_vert,fragmentShader:e,side:nn,blending:Ds,depthTest:!1,depthWrite:!1})}function Nv(){return Ho("PMREMGGXConvolution",{envMap:{value:null},roughness:{value:0},lodBias:{value:0}},`

		#define GGX_SAMPLES ${Gm}u

		varying vec3 vWorldDirection;

		uniform samplerCube envMap;
		uniform float roughness;
		uniform float lodBias;

		#include <common>

		// Van der Corput radical inverse
		float radicalInverse_VdC( uint bits ) {

			bits = ( bits << 16u ) | ( bits >> 16u );
			bits = ( ( bits & 0x55555555u ) << 1u ) | ( ( bits & 0xAAAAAAAAu ) >> 1u );
			bits = ( ( bits & 0x33333333u ) << 2u ) | ( ( bits & 0xCCCCCCCCu ) >> 2u );
			bits = ( ( bits & 0x0F0F0F0Fu ) << 4u ) | ( ( bits & 0xF0F0F0F0u ) >> 4u );
			bits = ( ( bits & 0x00FF00FFu ) << 8u ) | ( ( bits & 0xFF00FF00u ) >> 8u );
			return float( bits ) * 2.3283064365386963e-10; // / 0x100000000

		}

		// Hammersley sequence
		vec2 hammersley( uint i, uint N ) {

			return vec2( float( i ) / float( N ), radicalInverse_VdC( i ) );

		}

		void main() {

			vec3 N = normalize( vWorldDirection );

			// For very low roughness, just sample the environment directly
			if ( roughness < 0.001 ) {

				gl_FragColor = vec4( textureLod( envMap, N, 0.0 ).rgb, 1.0 );
				return;

			}

			float alpha = roughness * roughness;
			float alpha2 = alpha * alpha;

			// Tangent space basis for VNDF sampling
			vec3 up = abs( N.z ) < 0.999 ? vec3( 0.0, 0.0, 1.0 ) : vec3( 1.0, 0.0, 0.0 );
			vec3 tangent = normalize( cross( up, N ) );
			vec3 bitangent = cross( N, tangent );

			vec3 prefilteredColor = vec3( 0.0 );
			float totalWeight = 0.0;

			for ( uint i = 0u; i < GGX_SAMPLES; i ++ ) {

				vec2 Xi = hammersley( i, GGX_SAMPLES );

				// With V = N, sample the reflected direction directly.
				float invQ = 1.0 / ( 1.0 - Xi.x + alpha2 * Xi.x );
				float NdotL = ( 1.0 - Xi.x - alpha2 * Xi.x ) * invQ;

				if ( NdotL > 0.0 ) {

					float phi = 2.0 * PI * Xi.y;
					float sinTheta = 2.0 * alpha * sqrt( Xi.x * ( 1.0 - Xi.x ) ) * invQ;
					vec3 L = N * NdotL + ( tangent * cos( phi ) + bitangent * sin( phi ) ) * sinTheta;

					// Match the source mip to the sample's solid angle. The terms
					// independent of the sample are precomputed in lodBias.
					float d = alpha2 * invQ;
					float lod = max( log2( d ) + lodBias, 0.0 );

					// Weight by NdotL for the split-sum approximation
					prefilteredColor += textureLod( envMap, L, lod ).rgb * NdotL;
					totalWeight += NdotL;

				}

			}

			gl_FragColor = vec4( prefilteredColor / totalWeight, 1.0 );

		}
	`)}function Fv(){return Ho("PMREMGGXIntegration",{envMap:{value:null},roughness:{value:0},sourceLod:{value:0},sourceSize:{value:Hm}},`

		varying vec3 vWorldDirection;

		uniform samplerCube envMap;
		uniform float roughness;
		uniform float sourceLod;
		uniform int sourceSize;

		void main() {

			vec3 N = normalize( vWorldDirection );

			float alpha = roughness * roughness;
			float alpha2 = alpha * alpha;

			float texelSize = 2.0 / float( sourceSize );

			vec3 prefilteredColor = vec3( 0.0 );
			float totalWeight = 0.0;

			// Pair opposite texels: only the one in N's hemisphere contributes.
			for ( int face = 0; face < 3; face ++ ) {

				for ( int y = 0; y < sourceSize; y ++ ) {

					for ( int x = 0; x < sourceSize; x ++ ) {

						vec2 uv = ( vec2( x, y ) + 0.5 ) * texelSize - 1.0;
						vec3 texelDirection = face == 0 ? vec3( 1.0, uv ) : ( face == 1 ? vec3( uv.x, 1.0, uv.y ) : vec3( uv, 1.0 ) );

						float invDistance = inversesqrt( 1.0 + dot( uv, uv ) );
						float NdotL = dot( N, texelDirection );
						texelDirection *= NdotL < 0.0 ? - 1.0 : 1.0;
						NdotL = abs( NdotL ) * invDistance;

						// With V = N, NdotH squared is ( 1 + NdotL ) / 2. Common factors
						// in the GGX distribution and texel solid angle cancel when normalized.
						float d = 1.0 + alpha2 + ( alpha2 - 1.0 ) * NdotL;
						float weight = NdotL * invDistance * invDistance * invDistance / ( d * d );

						prefilteredColor += textureLod( envMap, texelDirection, sourceLod ).rgb * weight;
						totalWeight += weight;

					}

				}

			}

			gl_FragColor = vec4( prefilteredColor / totalWeight, 1.0 );

		}
	`)}function Uv(){return Ho("PMREMSphericalGaussianBlur",{envMap:{value:null},sigma:{value:0}},`

		#define SAMPLES ${Pv}
		#define GOLDEN_ANGLE 2.39996322973

		varying vec3 vWorldDirection;

		uniform samplerCube envMap;
		uniform float sigma;

		#include <common>

		void main() {

			vec3 outputDirection = normalize( vWorldDirection );

			vec3 up = abs( outputDirection.z ) < 0.999 ? vec3( 0.0, 0.0, 1.0 ) : vec3( 1.0, 0.0, 0.0 );
			vec3 tangent = normalize( cross( up, outputDirection ) );
			vec3 bitangent = cross( outputDirection, tangent );

			// Truncate the kernel at three standard deviations or at the antipode.
			float thetaMax = min( 3.0 * sigma, PI );
			float truncation = 1.0 - exp( - 0.5 * thetaMax * thetaMax / ( sigma * sigma ) );

			vec3 accumColor = vec3( 0.0 );
			float accumWeight = 0.0;

			for ( int i = 0; i < SAMPLES; i ++ ) {

				// Stratified inverse-CDF sampling of the Gaussian, placed on a golden-angle spiral.
				float stratum = ( float( i ) + 0.5 ) / float( SAMPLES );
				float theta = sigma * sqrt( - 2.0 * log( 1.0 - stratum * truncation ) );
				float phi = float( i ) * GOLDEN_ANGLE;

				vec3 offset = cos( phi ) * tangent + sin( phi ) * bitangent;
				vec3 sampleDirection = cos( theta ) * outputDirection + sin( theta ) * offset;

				// Correct the planar sample density to solid angle.
				float weight = sin( theta ) / theta;

				accumColor += weight * textureLod( envMap, sampleDirection, 0.0 ).rgb;
				accumWeight += weight;

			}

			gl_FragColor = vec4( accumColor / accumWeight, 1.0 );

		}
	`)}function bm(){return Ho("PMREMEquirectangularToCubemap",{envMap:{value:null}},`

		varying vec3 vWorldDirection;

		uniform sampler2D envMap;

		#include <common>

		void main() {

			// Average four subpixel samples to preserve small, bright features.
			vec3 direction = normalize( vWorldDirection );
			vec3 dx = dFdx( direction ) * 0.25;
			vec3 dy = dFdy( direction ) * 0.25;

			vec3 color = textureLod( envMap, equirectUv( normalize( direction - dx - dy ) ), 0.0 ).rgb;
			color += textureLod( envMap, equirectUv( normalize( direction + dx - dy ) ), 0.0 ).rgb;
			color += textureLod( envMap, equirectUv( normalize( direction - dx + dy ) ), 0.0 ).rgb;
			color += textureLod( envMap, equirectUv( normalize( direction + dx + dy ) ), 0.0 ).rgb;
			gl_FragColor = vec4( color * 0.25, 1.0 );

		}
	`)}function Sm(){return Ho("PMREMCubemapToCubemap",{envMap:{value:null},flipEnvMap:{value:-1}},`

		varying vec3 vWorldDirection;

		uniform samplerCube envMap;
		uniform float flipEnvMap;

		void main() {

			gl_FragColor = vec4( textureCube( envMap, vec3( flipEnvMap * vWorldDirection.x, vWorldDirection.yz ) ).rgb, 1.0 );

		}
	`)}function Ov(i){let t=new WeakMap,e=new WeakMap,n=null;function s(d,f=!1){return d==null?null:f?o(d):r(d)}function r(d){if(d&&d.isTexture){let f=d.mapping;if(f===zl||f===Vl)if(t.has(d)){let p=t.get(d).texture;return a(p,d.mapping)}else{let p=d.image;if(p&&p.height>0){let _=new Go(p.height);return _.fromEquirectangularTexture(i,d),t.set(d,_),d.addEventListener("dispose",c),a(_.texture,d.mapping)}else return null}}return d}function o(d){if(d&&d.isTexture&&d.isPMREMTexture!==!0){let f=d.mapping,p=f===zl||f===Vl,_=f===Fs||f===wr;if(p||_){let m=e.get(d),g=m!==void 0?m.texture.pmremVersion:0;if(d.isRenderTargetTexture&&d.pmremVersion!==g)return n===null&&(n=new Rc(i)),m=p?n.fromEquirectangular(d,m):n.fromCubemap(d,m),m.texture.pmremVersion=d.pmremVersion,e.set(d,m),m.texture;if(m!==void 0)return m.texture;{let y=d.image;return p&&y&&y.height>0||_&&y&&l(y)?(n===null&&(n=new Rc(i)),m=p?n.fromEquirectangular(d):n.fromCubemap(d),m.texture.pmremVersion=d.pmremVersion,e.set(d,m),d.addEventListener("dispose",h),m.texture):null}}}return d}function a(d,f){return f===zl?d.mapping=Fs:f===Vl&&(d.mapping=wr),d}function l(d){let f=0,p=6;for(let _=0;_<p;_++)d[_]!==void 0&&f++;return f===p}function c(d){let f=d.target;f.removeEventListener("dispose",c);let p=t.get(f);p!==void 0&&(t.delete(f),p.dispose())}function h(d){let f=d.target;f.removeEventListener("dispose",h);let p=e.get(f);p!==void 0&&(e.delete(f),p.dispose())}function u(){t=new WeakMap,e=new WeakMap,n!==null&&(n.dispose(),n=null)}return{get:s,dispose:u}}function Bv(i){let t={};function e(n){if(t[n]!==void 0)return t[n];let s=i.getExtension(n);return t[n]=s,s}return{has:function(n){return e(n)!==null},init:function(){e("EXT_color_buffer_float"),e("WEBGL_clip_cull_distance"),e("OES_texture_float_linear"),e("EXT_color_buffer_half_float"),e("WEBGL_multisampled_render_to_texture"),e("WEBGL_render_shared_exponent")},get:function(n){let s=e(n);return s===null&&ao("WebGLRenderer: "+n+" extension not supported."),s}}}function kv(i,t,e,n){let s={},r=new WeakMap,o=new FinalizationRegistry(p=>delete s[p]);function a(p){l(p.target)}function l(p){p.index!==null&&t.remove(p.index);for(let m in p.attributes)t.remove(p.attributes[m]);p.removeEventListener("dispose",a),delete s[p.id],o.unregister(p);let _=r.get(p);_&&(t.remove(_),r.delete(p)),n.releaseStatesOfGeometry(p),p.isInstancedBufferGeometry===!0&&delete p._maxInstanceCount,e.memory.geometries--}function c(p,_){return s[_.id]!==void 0||(_.addEventListener("dispose",a),s[_.id]=new WeakRef(_),o.register(_,_.id,_),e.memory.geometries++),_}function h(p){let _=p.attributes;for(let m in _)t.update(_[m],i.ARRAY_BUFFER)}function u(p){let _=p.index,m=p.attributes.position,g=0;if(m===void 0)return;let y=_!==null?_.array.length:m.array.length/3-1,b=m.count>=65535?xo:yo,v=new b(Math.ceil(y/3)*6,1),M=v.array;if(_!==null){let x=_.array;g=_.version;for(let w=0,D=0;w<y;w+=3){let R=x[w+0],N=x[w+1],P=x[w+2];M[D++]=R,M[D++]=N,M[D++]=N,M[D++]=P,M[D++]=P,M[D++]=R}}else{g=m.version;for(let x=0,w=0;x<y;x+=3){let D=x+0,R=x+1,N=x+2;M[w++]=D,M[w++]=R,M[w++]=R,M[w++]=N,M[w++]=N,M[w++]=D}}v.version=g;let A=r.get(p);A&&t.remove(A),r.set(p,v)}function d(p){let _=r.get(p);if(_){let m=p.index;m!==null&&_.version<m.version&&u(p)}else u(p);return r.get(p)}function f(){for(let p in s){let _=s[p].deref();_!==void 0&&l(_)}}return{get:c,update:h,getWireframeAttribute:d,dispose:f}}function zv(i,t,e){let n;function s(u){n=u}let r,o;function a(u){r=u.type,o=u.bytesPerElement}function l(u,d){i.drawElements(n,d,r,u*o),e.update(d,n,1)}function c(u,d,f){f!==0&&(i.drawElementsInstanced(n,d,r,u*o,f),e.update(d,n,f))}function h(u,d,f){if(f===0)return;t.get("WEBGL_multi_draw").multiDrawElementsWEBGL(n,d,0,r,u,0,f);let _=0;for(let m=0;m<f;m++)_+=d[m];e.update(_,n,1)}this.setMode=s,this.setIndex=a,this.render=l,this.renderInstances=c,this.renderMultiDraw=h}function Vv(i){let t={geometries:0,textures:0},e={frame:0,calls:0,triangles:0,points:0,lines:0};function n(r,o,a){switch(e.calls++,o){case i.TRIANGLES:e.triangles+=a*(r/3);break;case i.LINES:e.lines+=a*(r/2);break;case i.LINE_STRIP:e.lines+=a*(r-1);break;case i.LINE_LOOP:e.lines+=a*r;break;case i.POINTS:e.points+=a*r;break;default:Nt("WebGLInfo: Unknown draw mode:",o);break}}function s(){e.calls=0,e.triangles=0,e.points=0,e.lines=0}return{memory:t,render:e,programs:null,autoReset:!0,reset:s,update:n}}function Gv(i,t,e){let n=new WeakMap,s=new de;function r(o,a,l){let c=o.morphTargetInfluences,h=a.morphAttributes.position||a.morphAttributes.normal||a.morphAttributes.color,u=h!==void 0?h.length:0,d=n.get(a);if(d===void 0||d.count!==u){let D=function(){x.dispose(),n.delete(a),a.removeEventListener("dispose",D)};d!==void 0&&d.texture.dispose();let f=a.morphAttributes.position!==void 0,p=a.morphAttributes.normal!==void 0,_=a.morphAttributes.color!==void 0,m=a.morphAttributes.position||[],g=a.morphAttributes.normal||[],y=a.morphAttributes.color||[],b=0;f===!0&&(b=1),p===!0&&(b=2),_===!0&&(b=3);let v=a.attributes.position.count*b,M=1;v>t.maxTextureSize&&(M=Math.ceil(v/t.maxTextureSize),v=t.maxTextureSize);let A=new Float32Array(v*M*4*u),x=new go(A,v,M,u);x.type=Rn,x.needsUpdate=!0;let w=b*4;for(let R=0;R<u;R++){let N=m[R],P=g[R],U=y[R],L=v*M*4*R;for(let k=0;k<N.count;k++){let z=k*w;f===!0&&(s.fromBufferAttribute(N,k),A[L+z+0]=s.x,A[L+z+1]=s.y,A[L+z+2]=s.z,A[L+z+3]=0),p===!0&&(s.fromBufferAttribute(P,k),A[L+z+4]=s.x,A[L+z+5]=s.y,A[L+z+6]=s.z,A[L+z+7]=0),_===!0&&(s.fromBufferAttribute(U,k),A[L+z+8]=s.x,A[L+z+9]=s.y,A[L+z+10]=s.z,A[L+z+11]=U.itemSize===4?s.w:1)}}d={count:u,texture:x,size:new St(v,M)},n.set(a,d),a.addEventListener("dispose",D)}if(o.isInstancedMesh===!0&&o.morphTexture!==null)l.getUniforms().setValue(i,"morphTexture",o.morphTexture,e);else{let f=0;for(let _=0;_<c.length;_++)f+=c[_];let p=a.morphTargetsRelative?1:1-f;l.getUniforms().setValue(i,"morphTargetBaseInfluence",p),l.getUniforms().setValue(i,"morphTargetInfluences",c)}l.getUniforms().setValue(i,"morphTargetsTexture",d.texture,e),l.getUniforms().setValue(i,"morphTargetsTextureSize",d.size)}return{update:r}}function Hv(i,t,e,n,s){let r=new WeakMap;function o(c){let h=s.render.frame,u=c.geometry,d=t.get(c,u);if(r.get(d)!==h&&(t.update(d),r.set(d,h)),c.isInstancedMesh&&(c.hasEventListener("dispose",l)===!1&&c.addEventListener("dispose",l),r.get(c)!==h&&(e.update(c.instanceMatrix,i.ARRAY_BUFFER),c.instanceColor!==null&&e.update(c.instanceColor,i.ARRAY_BUFFER),r.set(c,h))),c.isSkinnedMesh){let f=c.skeleton;r.get(f)!==h&&(f.update(),r.set(f,h))}return d}function a(){r=new WeakMap}function l(c){let h=c.target;h.removeEventListener("dispose",l),n.releaseStatesOfObject(h),e.remove(h.instanceMatrix),h.instanceColor!==null&&e.remove(h.instanceColor)}return{update:o,dispose:a}}var Wv={[Mu]:"LINEAR_TONE_MAPPING",[wu]:"REINHARD_TONE_MAPPING",[Au]:"CINEON_TONE_MAPPING",[Eu]:"ACES_FILMIC_TONE_MAPPING",[Ru]:"AGX_TONE_MAPPING",[Cu]:"NEUTRAL_TONE_MAPPING",[Tu]:"CUSTOM_TONE_MAPPING"};function $v(i,t,e,n,s,r){let o=new Un(t,e,{type:i,depthBuffer:s,stencilBuffer:r,samples:n?4:0,storeMultisampledDepthBuffer:!1,storeMultisampledStencilBuffer:!1,resolveDepthBuffer:!1,resolveStencilBuffer:!1}),a=null,l=null,c=null,h=new Me;h.setAttribute("position",new Ze([-1,3,0,-1,-1,0,3,-1,0],3)),h.setAttribute("uv",new Ze([0,2,0,0,2,0],2));let u=new Al({uniforms:{tDiffuse:{value:null}},vertexShader:`
			precision highp float;

			uniform mat4 modelViewMatrix;
			uniform mat4 projectionMatrix;

			attribute vec3 position;
			attribute vec2 uv;

			varying vec2 vUv;

			void main() {
				vUv = uv;
				gl_Position = projectionMatrix * modelViewMatrix * vec4( position, 1.0 );
			}`,fragmentShader:`
			precision highp float;

			uniform sampler2D tDiffuse;

			varying vec2 vUv;

			#include <tonemapping_pars_fragment>
			#include <colorspace_pars_fragment>

			void main() {
				gl_FragColor = texture2D( tDiffuse, vUv );

				#ifdef LINEAR_TONE_MAPPING
					gl_FragColor.rgb = LinearToneMapping( gl_FragColor.rgb );
				#elif defined( REINHARD_TONE_MAPPING )
					gl_FragColor.rgb = ReinhardToneMapping( gl_FragColor.rgb );
				#elif defined( CINEON_TONE_MAPPING )
					gl_FragColor.rgb = CineonToneMapping( gl_FragColor.rgb );
				#elif defined( ACES_FILMIC_TONE_MAPPING )
					gl_FragColor.rgb = ACESFilmicToneMapping( gl_FragColor.rgb );
				#elif defined( AGX_TONE_MAPPING )
					gl_FragColor.rgb = AgXToneMapping( gl_FragColor.rgb );
				#elif defined( NEUTRAL_TONE_MAPPING )
					gl_FragColor.rgb = NeutralToneMapping( gl_FragColor.rgb );
				#elif defined( CUSTOM_TONE_MAPPING )
					gl_FragColor.rgb = CustomToneMapping( gl_FragColor.rgb );
				#endif

				#ifdef SRGB_TRANSFER
					gl_FragColor = sRGBTransferOETF( gl_FragColor );
				#endif
			}`,depthTest:!1,depthWrite:!1}),d=new Ee(h,u),f=new Bl(-1,1,1,-1,0,1),p=null,_=null,m=!1,g,y=null,b=[],v=!1;this.setSize=function(M,A){o.setSize(M,A),a!==null&&a.setSize(M,A),l!==null&&l.setSize(M,A);for(let x=0;x<b.length;x++){let w=b[x];w.setSize&&w.setSize(M,A)}},this.setEffects=function(M){b=M,v=b.length>0&&b[0].isRenderPass===!0;let A=o.width,x=o.height;b.length>0&&a===null&&(a=new Un(A,x,{type:li,depthBuffer:!1,stencilBuffer:!1}),l=new Un(A,x,{type:li,depthBuffer:!1,stencilBuffer:!1}));let w=s===!0&&b.some(D=>D.needsDepthTexture===!0);w!==(o.depthTexture!==null)&&(w===!0&&c===null&&(c=new Fi(A,x),r===!0&&(c.format=Gi,c.type=Us)),o.dispose(),o.depthTexture=w?c:null,o.resolveDepthBuffer=w,o.storeMultisampledDepthBuffer=w);for(let D=0;D<b.length;D++){let R=b[D];R.setSize&&R.setSize(A,x),w&&R.needsDepthTexture===!0&&R.setDepthTexture&&R.setDepthTexture(c)}},this.begin=function(M,A){if(m||M.toneMapping===gi&&b.length===0)return!1;if(y=A,A!==null){let x=A.width,w=A.height;(o.width!==x||o.height!==w)&&this.setSize(x,w)}return v===!1&&M.setRenderTarget(o),g=M.toneMapping,M.toneMapping=gi,!0},this.hasRenderPass=function(){return v},this.end=function(M,A){M.toneMapping=g,m=!0;let x=o,w=a;for(let D=0;D<b.length;D++){let R=b[D];R.enabled!==!1&&(R.render(M,w,x,A),R.needsSwap!==!1&&(x=w,w=w===a?l:a))}if(p!==M.outputColorSpace||_!==M.toneMapping){p=M.outputColorSpace,_=M.toneMapping,u.defines={},Jt.getTransfer(p)===oe&&(u.defines.SRGB_TRANSFER="");let D=Wv[_];D&&(u.defines[D]=""),u.needsUpdate=!0}u.uniforms.tDiffuse.value=x.texture,M.setRenderTarget(y),M.render(d,f),y=null,m=!1},this.isCompositing=function(){return m},this.dispose=function(){o.dispose(),a!==null&&a.dispose(),l!==null&&l.dispose(),h.dispose(),u.dispose()}}var Wm=new En,$m=new Fi(1,1),Xm=new Mo(1),qm=new go,Ym=new _r,Zm=new So,Mm=[],wm=[],Am=new Float32Array(16),Em=new Float32Array(9),Tm=new Float32Array(4);function Tr(i,t,e){let n=i[0];if(n<=0||n>0)return i;let s=t*e,r=Mm[s];if(r===void 0&&(r=new Float32Array(s),Mm[s]=r),t!==0){n.toArray(r,0);for(let o=1,a=0;o!==t;++o)a+=e,i[o].toArray(r,a)}return r}function Ve(i,t){if(i.length!==t.length)return!1;for(let e=0,n=i.length;e<n;e++)if(i[e]!==t[e])return!1;return!0}function Ge(i,t){for(let e=0,n=t.length;e<n;e++)i[e]=t[e]}function Ic(i,t){let e=wm[t];e===void 0&&(e=new Int32Array(t),wm[t]=e);for(let n=0;n!==t;++n)e[n]=i.allocateTextureUnit();return e}function Xv(i,t){let e=this.cache;e[0]!==t&&(i.uniform1f(this.addr,t),e[0]=t)}function qv(i,t){let e=this.cache;if(t.x!==void 0)(e[0]!==t.x||e[1]!==t.y)&&(i.uniform2f(this.addr,t.x,t.y),e[0]=t.x,e[1]=t.y);else{if(Ve(e,t))return;i.uniform2fv(this.addr,t),Ge(e,t)}}function Yv(i,t){let e=this.cache;if(t.x!==void 0)(e[0]!==t.x||e[1]!==t.y||e[2]!==t.z)&&(i.uniform3f(this.addr,t.x,t.y,t.z),e[0]=t.x,e[1]=t.y,e[2]=t.z);else if(t.r!==void 0)(e[0]!==t.r||e[1]!==t.g||e[2]!==t.b)&&(i.uniform3f(this.addr,t.r,t.g,t.b),e[0]=t.r,e[1]=t.g,e[2]=t.b);else{if(Ve(e,t))return;i.uniform3fv(this.addr,t),Ge(e,t)}}function Zv(i,t){let e=this.cache;if(t.x!==void 0)(e[0]!==t.x||e[1]!==t.y||e[2]!==t.z||e[3]!==t.w)&&(i.uniform4f(this.addr,t.x,t.y,t.z,t.w),e[0]=t.x,e[1]=t.y,e[2]=t.z,e[3]=t.w);else{if(Ve(e,t))return;i.uniform4fv(this.addr,t),Ge(e,t)}}function Jv(i,t){let e=this.cache,n=t.elements;if(n===void 0){if(Ve(e,t))return;i.uniformMatrix2fv(this.addr,!1,t),Ge(e,t)}else{if(Ve(e,n))return;Tm.set(n),i.uniformMatrix2fv(this.addr,!1,Tm),Ge(e,n)}}function Kv(i,t){let e=this.cache,n=t.elements;if(n===void 0){if(Ve(e,t))return;i.uniformMatrix3fv(this.addr,!1,t),Ge(e,t)}else{if(Ve(e,n))return;Em.set(n),i.uniformMatrix3fv(this.addr,!1,Em),Ge(e,n)}}function jv(i,t){let e=this.cache,n=t.elements;if(n===void 0){if(Ve(e,t))return;i.uniformMatrix4fv(this.addr,!1,t),Ge(e,t)}else{if(Ve(e,n))return;Am.set(n),i.uniformMatrix4fv(this.addr,!1,Am),Ge(e,n)}}function Qv(i,t){let e=this.cache;e[0]!==t&&(i.uniform1i(this.addr,t),e[0]=t)}function tb(i,t){let e=this.cache;if(t.x!==void 0)(e[0]!==t.x||e[1]!==t.y)&&(i.uniform2i(this.addr,t.x,t.y),e[0]=t.x,e[1]=t.y);else{if(Ve(e,t))return;i.uniform2iv(this.addr,t),Ge(e,t)}}function eb(i,t){let e=this.cache;if(t.x!==void 0)(e[0]!==t.x||e[1]!==t.y||e[2]!==t.z)&&(i.uniform3i(this.addr,t.x,t.y,t.z),e[0]=t.x,e[1]=t.y,e[2]=t.z);else{if(Ve(e,t))return;i.uniform3iv(this.addr,t),Ge(e,t)}}function nb(i,t){let e=this.cache;if(t.x!==void 0)(e[0]!==t.x||e[1]!==t.y||e[2]!==t.z||e[3]!==t.w)&&(i.uniform4i(this.addr,t.x,t.y,t.z,t.w),e[0]=t.x,e[1]=t.y,e[2]=t.z,e[3]=t.w);else{if(Ve(e,t))return;i.uniform4iv(this.addr,t),Ge(e,t)}}function ib(i,t){let e=this.cache;e[0]!==t&&(i.uniform1ui(this.addr,t),e[0]=t)}function sb(i,t){let e=this.cache;if(t.x!==void 0)(e[0]!==t.x||e[1]!==t.y)&&(i.uniform2ui(this.addr,t.x,t.y),e[0]=t.x,e[1]=t.y);else{if(Ve(e,t))return;i.uniform2uiv(this.addr,t),Ge(e,t)}}function rb(i,t){let e=this.cache;if(t.x!==void 0)(e[0]!==t.x||e[1]!==t.y||e[2]!==t.z)&&(i.uniform3ui(this.addr,t.x,t.y,t.z),e[0]=t.x,e[1]=t.y,e[2]=t.z);else{if(Ve(e,t))return;i.uniform3uiv(this.addr,t),Ge(e,t)}}function ob(i,t){let e=this.cache;if(t.x!==void 0)(e[0]!==t.x||e[1]!==t.y||e[2]!==t.z||e[3]!==t.w)&&(i.uniform4ui(this.addr,t.x,t.y,t.z,t.w),e[0]=t.x,e[1]=t.y,e[2]=t.z,e[3]=t.w);else{if(Ve(e,t))return;i.uniform4uiv(this.addr,t),Ge(e,t)}}function Lc(i){return i.version===0&&(i.compareFunction=zu,i.needsUpdate=!0),i}function ab(i,t,e){let n=this.cache,s=e.allocateTextureUnit();n[0]!==s&&(i.uniform1i(this.addr,s),n[0]=s);let r;this.type===i.SAMPLER_2D_SHADOW?r=Lc($m):r=Wm,e.setTexture2D(t||r,s)}function lb(i,t,e){let n=this.cache,s=e.allocateTextureUnit();n[0]!==s&&(i.uniform1i(this.addr,s),n[0]=s),e.setTexture3D(t||Ym,s)}function cb(i,t,e){let n=this.cache,s=e.allocateTextureUnit();n[0]!==s&&(i.uniform1i(this.addr,s),n[0]=s);let r;this.type===i.SAMPLER_CUBE_SHADOW?r=Lc(Xm):r=Zm,e.setTextureCube(t||r,s)}function hb(i,t,e){let n=this.cache,s=e.allocateTextureUnit();n[0]!==s&&(i.uniform1i(this.addr,s),n[0]=s),e.setTexture2DArray(t||qm,s)}function ub(i){switch(i){case 5126:return Xv;case 35664:return qv;case 35665:return Yv;case 35666:return Zv;case 35674:return Jv;case 35675:return Kv;case 35676:return jv;case 5124:case 35670:return Qv;case 35667:case 35671:return tb;case 35668:case 35672:return eb;case 35669:case 35673:return nb;case 5125:return ib;case 36294:return sb;case 36295:return rb;case 36296:return ob;case 35678:case 36198:case 36298:case 36306:case 35682:return ab;case 35679:case 36299:case 36307:return lb;case 35680:case 36300:case 36308:case 36293:return cb;case 36289:case 36303:case 36311:case 36292:return hb}}function db(i,t){i.uniform1fv(this.addr,t)}function fb(i,t){let e=Tr(t,this.size,2);i.uniform2fv(this.addr,e)}function pb(i,t){let e=Tr(t,this.size,3);i.uniform3fv(this.addr,e)}function mb(i,t){let e=Tr(t,this.size,4);i.uniform4fv(this.addr,e)}function gb(i,t){let e=Tr(t,this.size,4);i.uniformMatrix2fv(this.addr,!1,e)}function _b(i,t){let e=Tr(t,this.size,9);i.uniformMatrix3fv(this.addr,!1,e)}function yb(i,t){let e=Tr(t,this.size,16);i.uniformMatrix4fv(this.addr,!1,e)}function xb(i,t){i.uniform1iv(this.addr,t)}function vb(i,t){i.uniform2iv(this.addr,t)}function bb(i,t){i.uniform3iv(this.addr,t)}function Sb(i,t){i.uniform4iv(this.addr,t)}function Mb(i,t){i.uniform1uiv(this.addr,t)}function wb(i,t){i.uniform2uiv(this.addr,t)}function Ab(i,t){i.uniform3uiv(this.addr,t)}function Eb(i,t){i.uniform4uiv(this.addr,t)}function Tb(i,t,e){let n=this.cache,s=t.length,r=Ic(e,s);Ve(n,r)||(i.uniform1iv(this.addr,r),Ge(n,r));let o;this.type===i.SAMPLER_2D_SHADOW?o=Lc($m):o=Wm;for(let a=0;a!==s;++a)e.setTexture2D(t[a]||o,r[a])}function Rb(i,t,e){let n=this.cache,s=t.length,r=Ic(e,s);Ve(n,r)||(i.uniform1iv(this.addr,r),Ge(n,r));for(let o=0;o!==s;++o)e.setTexture3D(t[o]||Ym,r[o])}function Cb(i,t,e){let n=this.cache,s=t.length,r=Ic(e,s);Ve(n,r)||(i.uniform1iv(this.addr,r),Ge(n,r));let o;this.type===i.SAMPLER_CUBE_SHADOW?o=Lc(Xm):o=Zm;for(let a=0;a!==s;++a)e.setTextureCube(t[a]||o,r[a])}function Pb(i,t,e){let n=this.cache,s=t.length,r=Ic(e,s);Ve(n,r)||(i.uniform1iv(this.addr,r),Ge(n,r));for(let o=0;o!==s;++o)e.setTexture2DArray(t[o]||qm,r[o])}function Ib(i){switch(i){case 5126:return db;case 35664:return fb;case 35665:return pb;case 35666:return mb;case 35674:return gb;case 35675:return _b;case 35676:return yb;case 5124:case 35670:return xb;case 35667:case 35671:return vb;case 35668:case 35672:return bb;case 35669:case 35673:return Sb;case 5125:return Mb;case 36294:return wb;case 36295:return Ab;case 36296:return Eb;case 35678:case 36198:case 36298:case 36306:case 35682:return Tb;case 35679:case 36299:case 36307:return Rb;case 35680:case 36300:case 36308:case 36293:return Cb;case 36289:case 36303:case 36311:case 36292:return Pb}}var Qu=class{constructor(t,e,n){this.id=t,this.addr=n,this.cache=[],this.type=e.type,this.setValue=ub(e.type)}},td=class{constructor(t,e,n){this.id=t,this.addr=n,this.cache=[],this.type=e.type,this.size=e.size,this.setValue=Ib(e.type)}},ed=class{constructor(t){this.id=t,this.seq=[],this.map={}}setValue(t,e,n){let s=this.seq;for(let r=0,o=s.length;r!==o;++r){let a=s[r];a.setValue(t,e[a.id],n)}}},Ku=/(\w+)(\])?(\[|\.)?/g;function Rm(i,t){i.seq.push(t),i.map[t.id]=t}function Lb(i,t,e){let n=i.name,s=n.length;for(Ku.lastIndex=0;;){let r=Ku.exec(n),o=Ku.lastIndex,a=r[1],l=r[2]==="]",c=r[3];if(l&&(a=a|0),c===void 0||c==="["&&o+2===s){Rm(e,c===void 0?new Qu(a,i,t):new td(a,i,t));break}else{let u=e.map[a];u===void 0&&(u=new ed(a),Rm(e,u)),e=u}}}var Er=class{constructor(t,e){this.seq=[],this.map={};let n=t.getProgramParameter(e,t.ACTIVE_UNIFORMS);for(let o=0;o<n;++o){let a=t.getActiveUniform(e,o),l=t.getUniformLocation(e,a.name);Lb(a,l,this)}let s=[],r=[];for(let o of this.seq)o.type===t.SAMPLER_2D_SHADOW||o.type===t.SAMPLER_CUBE_SHADOW||o.type===t.SAMPLER_2D_ARRAY_SHADOW?s.push(o):r.push(o);s.length>0&&(this.seq=s.concat(r))}setValue(t,e,n,s){let r=this.map[e];r!==void 0&&r.setValue(t,n,s)}setOptional(t,e,n){let s=e[n];s!==void 0&&this.setValue(t,n,s)}static upload(t,e,n,s){for(let r=0,o=e.length;r!==o;++r){let a=e[r],l=n[a.id];l.needsUpdate!==!1&&a.setValue(t,l.value,s)}}static seqWithValue(t,e){let n=[];for(let s=0,r=t.length;s!==r;++s){let o=t[s];o.id in e&&n.push(o)}return n}};function Cm(i,t,e){let n=i.createShader(t);return i.shaderSource(n,e),i.compileShader(n),n}var Db=37297,Nb=0;function Fb(i,t){let e=i.split(`
`),n=[],s=Math.max(t-6,0),r=Math.min(t+6,e.length);for(let o=s;o<r;o++){let a=o+1;n.push(`${a===t?">":" "} ${a}: ${e[o]}`)}return n.join(`
`)}var Pm=new Ut;function Ub(i){Jt._getMatrix(Pm,Jt.workingColorSpace,i);let t=`mat3( ${Pm.elements.map(e=>e.toFixed(4))} )`;switch(Jt.getTransfer(i)){case uo:return[t,"LinearTransferOETF"];case oe:return[t,"sRGBTransferOETF"];default:return It("WebGLProgram: Unsupported color space: ",i),[t,"LinearTransferOETF"]}}function Im(i,t,e){let n=i.getShaderParameter(t,i.COMPILE_STATUS),r=(i.getShaderInfoLog(t)||"").trim();if(n&&r==="")return"";let o=/ERROR: 0:(\d+)/.exec(r);if(o){let a=parseInt(o[1]);return e.toUpperCase()+`

`+r+`

`+Fb(i.getShaderSource(t),a)}else return r}function Ob(i,t){let e=Ub(t);return[`vec4 ${i}( vec4 value ) {`,`	return ${e[1]}( vec4( ${e[0]} * value.rgb, value.a ) );`,"}"].join(`
`)}var Bb={[Mu]:"Linear",[wu]:"Reinhard",[Au]:"Cineon",[Eu]:"ACESFilmic",[Ru]:"AgX",[Cu]:"Neutral",[Tu]:"Custom"};function kb(i,t){let e=Bb[t];return e===void 0?(It("WebGLProgram: Unsupported toneMapping:",t),"vec3 "+i+"( vec3 color ) { return LinearToneMapping( color ); }"):"vec3 "+i+"( vec3 color ) { return "+e+"ToneMapping( color ); }"}var Tc=new C;function zb(){Jt.getLuminanceCoefficients(Tc);let i=Tc.x.toFixed(4),t=Tc.y.toFixed(4),e=Tc.z.toFixed(4);return["float luminance( const in vec3 rgb ) {",`	const vec3 weights = vec3( ${i}, ${t}, ${e} );`,"	return dot( weights, rgb );","}"].join(`
`)}function Vb(i){return[i.extensionClipCullDistance?"#extension GL_ANGLE_clip_cull_distance : require":"",i.extensionMultiDraw?"#extension GL_ANGLE_multi_draw : require":""].filter(Vo).join(`
`)}function Gb(i){let t=[];for(let e in i){let n=i[e];n!==!1&&t.push("#define "+e+" "+n)}return t.join(`
`)}function Hb(i,t){let e={},n=i.getProgramParameter(t,i.ACTIVE_ATTRIBUTES);for(let s=0;s<n;s++){let r=i.getActiveAttrib(t,s),o=r.name,a=1;r.type===i.FLOAT_MAT2&&(a=2),r.type===i.FLOAT_MAT3&&(a=3),r.type===i.FLOAT_MAT4&&(a=4),e[o]={type:r.type,location:i.getAttribLocation(t,o),locationSize:a}}return e}function Vo(i){return i!==""}function Lm(i,t){let e=t.numSpotLightShadows+t.numSpotLightMaps-t.numSpotLightShadowsWithMaps;return i.replace(/NUM_SUN_LIGHTS/g,t.numSunLights).replace(/NUM_DIR_LIGHTS/g,t.numDirLights).replace(/NUM_SPOT_LIGHTS/g,t.numSpotLights).replace(/NUM_SPOT_LIGHT_MAPS/g,t.numSpotLightMaps).replace(/NUM_SPOT_LIGHT_COORDS/g,e).replace(/NUM_RECT_AREA_LIGHTS/g,t.numRectAreaLights).replace(/NUM_POINT_LIGHTS/g,t.numPointLights).replace(/NUM_HEMI_LIGHTS/g,t.numHemiLights).replace(/NUM_SUN_LIGHT_SHADOWS/g,t.numSunLightShadows).replace(/NUM_DIR_LIGHT_SHADOWS/g,t.numDirLightShadows).replace(/NUM_SPOT_LIGHT_SHADOWS_WITH_MAPS/g,t.numSpotLightShadowsWithMaps).replace(/NUM_SPOT_LIGHT_SHADOWS/g,t.numSpotLightShadows).replace(/NUM_POINT_LIGHT_SHADOWS/g,t.numPointLightShadows).replace(/NUM_LIGHT_PROBE_GRIDS/g,t.numLightProbeGrids)}function Dm(i,t){return i.replace(/NUM_CLIPPING_PLANES/g,t.numClippingPlanes).replace(/UNION_CLIPPING_PLANES/g,t.numClippingPlanes-t.numClipIntersection)}var Wb=/^[ \t]*#include +<([\w\d./]+)>/gm;function nd(i){return i.replace(Wb,$b)}function $b(i,t){let e=$t[t];if(e===void 0)throw new Error("THREE.WebGLProgram: Can not resolve #include <"+t+">");return nd(e)}var Xb=/#pragma unroll_loop_start\s+for\s*\(\s*int\s+i\s*=\s*(\d+)\s*;\s*i\s*<\s*(\d+)\s*;\s*i\s*\+\+\s*\)\s*{([\s\S]+?)}\s+#pragma unroll_loop_end/g;function Nm(i){return i.replace(Xb,qb)}function qb(i,t,e,n){let s="";for(let r=parseInt(t);r<parseInt(e);r++)s+=n.replace(/\[\s*i\s*\]/g,"[ "+r+" ]").replace(/UNROLLED_LOOP_INDEX/g,r);return s}function Fm(i){let t=`precision ${i.precision} float;
	precision ${i.precision} int;
	precision ${i.precision} sampler2D;
	precision ${i.precision} samplerCube;
	precision ${i.precision} sampler3D;
	precision ${i.precision} sampler2DArray;
	precision ${i.precision} sampler2DShadow;
	precision ${i.precision} samplerCubeShadow;
	precision ${i.precision} sampler2DArrayShadow;
	precision ${i.precision} isampler2D;
	precision ${i.precision} isampler3D;
	precision ${i.precision} isamplerCube;
	precision ${i.precision} isampler2DArray;
	precision ${i.precision} usampler2D;
	precision ${i.precision} usampler3D;
	precision ${i.precision} usamplerCube;
	precision ${i.precision} usampler2DArray;
	`;return i.precision==="highp"?t+=`
#define HIGH_PRECISION`:i.precision==="mediump"?t+=`
#define MEDIUM_PRECISION`:i.precision==="lowp"&&(t+=`
#define LOW_PRECISION`),t}var Yb={[Io]:"SHADOWMAP_TYPE_PCF",[Sr]:"SHADOWMAP_TYPE_VSM"};function Zb(i){return Yb[i.shadowMapType]||"SHADOWMAP_TYPE_BASIC"}var Jb={[wr]:"ENVMAP_MODE_REFRACTION"};function Kb(i){return i.envMap===!1?"ENVMAP_MODE_REFLECTION":Jb[i.envMapMode]||"ENVMAP_MODE_REFLECTION"}var jb={[Su]:"ENVMAP_BLENDING_MULTIPLY",[tm]:"ENVMAP_BLENDING_MIX",[em]:"ENVMAP_BLENDING_ADD"};function Qb(i){return i.envMap===!1?"ENVMAP_BLENDING_NONE":jb[i.combine]||"ENVMAP_BLENDING_NONE"}function tS(i,t,e,n){let s=i.getContext(),r=e.defines,o=e.vertexShader,a=e.fragmentShader,l=Zb(e),c=e.envMapPMREM===!0?"ENVMAP_TYPE_PMREM":"ENVMAP_TYPE_CUBE",h=Kb(e),u=Qb(e),d=Vb(e),f=Gb(r),p=s.createProgram(),_,m,g=e.glslVersion?"#version "+e.glslVersion+`
`:"";e.isRawShaderMaterial?(_=["#define SHADER_TYPE "+e.shaderType,"#define SHADER_NAME "+e.shaderName,f].filter(Vo).join(`
`),_.length>0&&(_+=`
`),m=["#define SHADER_TYPE "+e.shaderType,"#define SHADER_NAME "+e.shaderName,f].filter(Vo).join(`
`),m.length>0&&(m+=`
`)):(_=[Fm(e),"#define SHADER_TYPE "+e.shaderType,"#define SHADER_NAME "+e.shaderName,f,e.extensionClipCullDistance?"#define USE_CLIP_DISTANCE":"",e.batching?"#define USE_BATCHING":"",e.batchingColor?"#define USE_BATCHING_COLOR":"",e.instancing?"#define USE_INSTANCING":"",e.instancingColor?"#define USE_INSTANCING_COLOR":"",e.instancingMorph?"#define USE_INSTANCING_MORPH":"",e.useFog&&e.fog?"#define USE_FOG":"",e.useFog&&e.fogExp2?"#define FOG_EXP2":"",e.map?"#define USE_MAP":"",e.envMap?"#define USE_ENVMAP":"",e.envMap?"#define "+h:"",e.lightMap?"#define USE_LIGHTMAP":"",e.aoMap?"#define USE_AOMAP":"",e.bumpMap?"#define USE_BUMPMAP":"",e.normalMap?"#define USE_NORMALMAP":"",e.normalMapObjectSpace?"#define USE_NORMALMAP_OBJECTSPACE":"",e.normalMapTangentSpace?"#define USE_NORMALMAP_TANGENTSPACE":"",e.displacementMap?"#define USE_DISPLACEMENTMAP":"",e.emissiveMap?"#define USE_EMISSIVEMAP":"",e.anisotropy?"#define USE_ANISOTROPY":"",e.anisotropyMap?"#define USE_ANISOTROPYMAP":"",e.clearcoatMap?"#define USE_CLEARCOATMAP":"",e.clearcoatRoughnessMap?"#define USE_CLEARCOAT_ROUGHNESSMAP":"",e.clearcoatNormalMap?"#define USE_CLEARCOAT_NORMALMAP":"",e.diffuseRoughnessMap?"#define USE_DIFFUSE_ROUGHNESSMAP":"",e.iridescenceMap?"#define USE_IRIDESCENCEMAP":"",e.iridescenceThicknessMap?"#define USE_IRIDESCENCE_THICKNESSMAP":"",e.specularMap?"#define USE_SPECULARMAP":"",e.specularColorMap?"#define USE_SPECULAR_COLORMAP":"",e.specularIntensityMap?"#define USE_SPECULAR_INTENSITYMAP":"",e.roughnessMap?"#define USE_ROUGHNESSMAP":"",e.metalnessMap?"#define USE_METALNESSMAP":"",e.alphaMap?"#define USE_ALPHAMAP":"",e.alphaHash?"#define USE_ALPHAHASH":"",e.transmission?"#define USE_TRANSMISSION":"",e.transmissionMap?"#define USE_TRANSMISSIONMAP":"",e.thicknessMap?"#define USE_THICKNESSMAP":"",e.sheenColorMap?"#define USE_SHEEN_COLORMAP":"",e.sheenRoughnessMap?"#define USE_SHEEN_ROUGHNESSMAP":"",e.mapUv?"#define MAP_UV "+e.mapUv:"",e.alphaMapUv?"#define ALPHAMAP_UV "+e.alphaMapUv:"",e.lightMapUv?"#define LIGHTMAP_UV "+e.lightMapUv:"",e.aoMapUv?"#define AOMAP_UV "+e.aoMapUv:"",e.emissiveMapUv?"#define EMISSIVEMAP_UV "+e.emissiveMapUv:"",e.bumpMapUv?"#define BUMPMAP_UV "+e.bumpMapUv:"",e.normalMapUv?"#define NORMALMAP_UV "+e.normalMapUv:"",e.displacementMapUv?"#define DISPLACEMENTMAP_UV "+e.displacementMapUv:"",e.metalnessMapUv?"#define METALNESSMAP_UV "+e.metalnessMapUv:"",e.roughnessMapUv?"#define ROUGHNESSMAP_UV "+e.roughnessMapUv:"",e.anisotropyMapUv?"#define ANISOTROPYMAP_UV "+e.anisotropyMapUv:"",e.clearcoatMapUv?"#define CLEARCOATMAP_UV "+e.clearcoatMapUv:"",e.clearcoatNormalMapUv?"#define CLEARCOAT_NORMALMAP_UV "+e.clearcoatNormalMapUv:"",e.clearcoatRoughnessMapUv?"#define CLEARCOAT_ROUGHNESSMAP_UV "+e.clearcoatRoughnessMapUv:"",e.diffuseRoughnessMapUv?"#define DIFFUSE_ROUGHNESSMAP_UV "+e.diffuseRoughnessMapUv:"",e.iridescenceMapUv?"#define IRIDESCENCEMAP_UV "+e.iridescenceMapUv:"",e.iridescenceThicknessMapUv?"#define IRIDESCENCE_THICKNESSMAP_UV "+e.iridescenceThicknessMapUv:"",e.sheenColorMapUv?"#define SHEEN_COLORMAP_UV "+e.sheenColorMapUv:"",e.sheenRoughnessMapUv?"#define SHEEN_ROUGHNESSMAP_UV "+e.sheenRoughnessMapUv:"",e.specularMapUv?"#define SPECULARMAP_UV "+e.specularMapUv:"",e.specularColorMapUv?"#define SPECULAR_COLORMAP_UV "+e.specularColorMapUv:"",e.specularIntensityMapUv?"#define SPECULAR_INTENSITYMAP_UV "+e.specularIntensityMapUv:"",e.transmissionMapUv?"#define TRANSMISSIONMAP_UV "+e.transmissionMapUv:"",e.thicknessMapUv?"#define THICKNESSMAP_UV "+e.thicknessMapUv:"",e.vertexTangents&&e.flatShading===!1?"#define USE_TANGENT":"",e.vertexNormals?"#define HAS_NORMAL":"",e.vertexColors?"#define USE_COLOR":"",e.vertexAlphas?"#define USE_COLOR_ALPHA":"",e.vertexUv1s?"#define USE_UV1":"",e.vertexUv2s?"#define USE_UV2":"",e.vertexUv3s?"#define USE_UV3":"",e.pointsUvs?"#define USE_POINTS_UV":"",e.flatShading?"#define FLAT_SHADED":"",e.skinning?"#define USE_SKINNING":"",e.morphTargets?"#define USE_MORPHTARGETS":"",e.morphNormals&&e.flatShading===!1?"#define USE_MORPHNORMALS":"",e.morphColors?"#define USE_MORPHCOLORS":"",e.morphTargetsCount>0?"#define MORPHTARGETS_TEXTURE_STRIDE "+e.morphTextureStride:"",e.morphTargetsCount>0?"#define MORPHTARGETS_COUNT "+e.morphTargetsCount:"",e.doubleSided?"#define DOUBLE_SIDED":"",e.flipSided?"#define FLIP_SIDED":"",e.shadowMapEnabled?"#define USE_SHADOWMAP":"",e.shadowMapEnabled?"#define "+l:"",e.sizeAttenuation?"#define USE_SIZEATTENUATION":"",e.numLightProbes>0?"#define USE_LIGHT_PROBES":"",e.logarithmicDepthBuffer?"#define USE_LOGARITHMIC_DEPTH_BUFFER":"",e.reversedDepthBuffer?"#define USE_REVERSED_DEPTH_BUFFER":"","uniform mat4 modelMatrix;","uniform mat4 modelViewMatrix;","uniform mat4 projectionMatrix;","uniform mat4 viewMatrix;","uniform mat3 normalMatrix;","uniform vec3 cameraPosition;","uniform bool isOrthographic;","#ifdef USE_INSTANCING","	attribute mat4 instanceMatrix;","#endif","#ifdef USE_INSTANCING_COLOR","	attribute vec3 instanceColor;","#endif","#ifdef USE_INSTANCING_MORPH","	uniform sampler2D morphTexture;","#endif","attribute vec3 position;","attribute vec3 normal;","attribute vec2 uv;","#ifdef USE_UV1","	attribute vec2 uv1;","#endif","#ifdef USE_UV2","	attribute vec2 uv2;","#endif","#ifdef USE_UV3","	attribute vec2 uv3;","#endif","#ifdef USE_TANGENT","	attribute vec4 tangent;","#endif","#if defined( USE_COLOR_ALPHA )","	attribute vec4 color;","#elif defined( USE_COLOR )","	attribute vec3 color;","#endif","#ifdef USE_SKINNING","	attribute vec4 skinIndex;","	attribute vec4 skinWeight;","#endif",`
`].filter(Vo).join(`
`),m=[Fm(e),"#define SHADER_TYPE "+e.shaderType,"#define SHADER_NAME "+e.shaderName,f,e.useFog&&e.fog?"#define USE_FOG":"",e.useFog&&e.fogExp2?"#define FOG_EXP2":"",e.alphaToCoverage?"#define ALPHA_TO_COVERAGE":"",e.map?"#define USE_MAP":"",e.matcap?"#define USE_MATCAP":"",e.envMap?"#define USE_ENVMAP":"",e.envMap?"#define "+c:"",e.envMap?"#define "+h:"",e.envMap?"#define "+u:"",e.envMapPMREM?"#define ENVMAP_MAX_LOD "+e.envMapMaxLod+".0":"",e.envMapPMREM?"#define ENVMAP_SIZE "+e.envMapSize+".0":"",e.lightMap?"#define USE_LIGHTMAP":"",e.aoMap?"#define USE_AOMAP":"",e.bumpMap?"#define USE_BUMPMAP":"",e.normalMap?"#define USE_NORMALMAP":"",e.normalMapObjectSpace?"#define USE_NORMALMAP_OBJECTSPACE":"",e.normalMapTangentSpace?"#define USE_NORMALMAP_TANGENTSPACE":"",e.packedNormalMap?"#define USE_PACKED_NORMALMAP":"",e.emissiveMap?"#define USE_EMISSIVEMAP":"",e.anisotropy?"#define USE_ANISOTROPY":"",e.anisotropyMap?"#define USE_ANISOTROPYMAP":"",e.clearcoat?"#define USE_CLEARCOAT":"",e.clearcoatMap?"#define USE_CLEARCOATMAP":"",e.clearcoatRoughnessMap?"#define USE_CLEARCOAT_ROUGHNESSMAP":"",e.clearcoatNormalMap?"#define USE_CLEARCOAT_NORMALMAP":"",e.diffuseRoughness?"#define USE_DIFFUSE_ROUGHNESS":"",e.diffuseRoughnessMap?"#define USE_DIFFUSE_ROUGHNESSMAP":"",e.dispersion?"#define USE_DISPERSION":"",e.retroreflection?"#define USE_RETROREFLECTION":"",e.iridescence?"#define USE_IRIDESCENCE":"",e.iridescenceMap?"#define USE_IRIDESCENCEMAP":"",e.iridescenceThicknessMap?"#define USE_IRIDESCENCE_THICKNESSMAP":"",e.specularMap?"#define USE_SPECULARMAP":"",e.specularColorMap?"#define USE_SPECULAR_COLORMAP":"",e.specularIntensityMap?"#define USE_SPECULAR_INTENSITYMAP":"",e.roughnessMap?"#define USE_ROUGHNESSMAP":"",e.metalnessMap?"#define USE_METALNESSMAP":"",e.alphaMap?"#define USE_ALPHAMAP":"",e.alphaTest?"#define USE_ALPHATEST":"",e.alphaHash?"#define USE_ALPHAHASH":"",e.sheen?"#define USE_SHEEN":"",e.sheenColorMap?"#define USE_SHEEN_COLORMAP":"",e.sheenRoughnessMap?"#define USE_SHEEN_ROUGHNESSMAP":"",e.transmission?"#define USE_TRANSMISSION":"",e.transmissionMap?"#define USE_TRANSMISSIONMAP":"",e.thicknessMap?"#define USE_THICKNESSMAP":"",e.vertexTangents&&e.flatShading===!1?"#define USE_TANGENT":"",e.vertexColors||e.instancingColor?"#define USE_COLOR":"",e.vertexAlphas||e.batchingColor?"#define USE_COLOR_ALPHA":"",e.vertexUv1s?"#define USE_UV1":"",e.vertexUv2s?"#define USE_UV2":"",e.vertexUv3s?"#define USE_UV3":"",e.pointsUvs?"#define USE_POINTS_UV":"",e.gradientMap?"#define USE_GRADIENTMAP":"",e.flatShading?"#define FLAT_SHADED":"",e.doubleSided?"#define DOUBLE_SIDED":"",e.flipSided?"#define FLIP_SIDED":"",e.shadowMapEnabled?"#define USE_SHADOWMAP":"",e.shadowMapEnabled?"#define "+l:"",e.premultipliedAlpha?"#define PREMULTIPLIED_ALPHA":"",e.numLightProbes>0?"#define USE_LIGHT_PROBES":"",e.decodeVideoTexture?"#define DECODE_VIDEO_TEXTURE":"",e.decodeVideoTextureEmissive?"#define DECODE_VIDEO_TEXTURE_EMISSIVE":"",e.logarithmicDepthBuffer?"#define USE_LOGARITHMIC_DEPTH_BUFFER":"",e.reversedDepthBuffer?"#define USE_REVERSED_DEPTH_BUFFER":"","uniform mat4 viewMatrix;","uniform vec3 cameraPosition;","uniform bool isOrthographic;",e.toneMapping!==gi?"#define TONE_MAPPING":"",e.toneMapping!==gi?$t.tonemapping_pars_fragment:"",e.toneMapping!==gi?kb("toneMapping",e.toneMapping):"",e.dithering?"#define DITHERING":"",e.opaque?"#define OPAQUE":"",$t.colorspace_pars_fragment,Ob("linearToOutputTexel",e.outputColorSpace),zb(),e.useDepthPacking?"#define DEPTH_PACKING "+e.depthPacking:"",`
`].filter(Vo).join(`
`)),o=nd(o),o=Lm(o,e),o=Dm(o,e),a=nd(a),a=Lm(a,e),a=Dm(a,e),o=Nm(o),a=Nm(a),e.isRawShaderMaterial!==!0&&(g=`#version 300 es
`,_=[d,"#define attribute in","#define varying out","#define texture2D texture"].join(`
`)+`
`+_,m=["#define varying in",e.glslVersion===Cn?"":"layout(location = 0) out highp vec4 pc_fragColor;",e.glslVersion===Cn?"":"#define gl_FragColor pc_fragColor","#define gl_FragDepthEXT gl_FragDepth","#define texture2D texture","#define textureCube texture","#define texture2DProj textureProj","#define texture2DLodEXT textureLod","#define texture2DProjLodEXT textureProjLod","#define textureCubeLodEXT textureLod","#define texture2DGradEXT textureGrad","#define texture2DProjGradEXT textureProjGrad","#define textureCubeGradEXT textureGrad"].join(`
`)+`
`+m);let y=g+_+o,b=g+m+a,v=Cm(s,s.VERTEX_SHADER,y),M=Cm(s,s.FRAGMENT_SHADER,b);s.attachShader(p,v),s.attachShader(p,M),e.index0AttributeName!==void 0?s.bindAttribLocation(p,0,e.index0AttributeName):e.hasPositionAttribute===!0&&s.bindAttribLocation(p,0,"position"),s.linkProgram(p);function A(R){if(i.debug.checkShaderErrors){let N=s.getProgramInfoLog(p)||"",P=s.getShaderInfoLog(v)||"",U=s.getShaderInfoLog(M)||"",L=N.trim(),k=P.trim(),z=U.trim(),W=!0,et=!0;if(s.getProgramParameter(p,s.LINK_STATUS)===!1)if(W=!1,typeof i.debug.onShaderError=="function")i.debug.onShaderError(s,p,v,M);else{let X=Im(s,v,"vertex"),Q=Im(s,M,"fragment");Nt("WebGLProgram: Shader Error "+s.getError()+" - VALIDATE_STATUS "+s.getProgramParameter(p,s.VALIDATE_STATUS)+`

Material Name: `+R.name+`
Material Type: `+R.type+`

Program Info Log: `+L+`
`+X+`
`+Q)}else L!==""?It("WebGLProgram: Program Info Log:",L):(k===""||z==="")&&(et=!1);et&&(R.diagnostics={runnable:W,programLog:L,vertexShader:{log:k,prefix:_},fragmentShader:{log:z,prefix:m}})}s.deleteShader(v),s.deleteShader(M),x=new Er(s,p),w=Hb(s,p)}let x;this.getUniforms=function(){return x===void 0&&A(this),x};let w;this.getAttributes=function(){return w===void 0&&A(this),w};let D=e.rendererExtensionParallelShaderCompile===!1;return this.isReady=function(){return D===!1&&(D=s.getProgramParameter(p,Db)),D},this.destroy=function(){n.releaseStatesOfProgram(this),s.deleteProgram(p),this.program=void 0},this.type=e.shaderType,this.name=e.shaderName,this.id=Nb++,this.cacheKey=t,this.usedTimes=1,this.program=p,this.vertexShader=v,this.fragmentShader=M,this}var eS=0,id=class{constructor(){this.shaderCache=new Map,this.materialCache=new Map}update(t,e,n){let s=this._getShaderCacheForMaterial(t);return s.has(e)===!1&&(s.add(e),e.usedTimes++),s.has(n)===!1&&(s.add(n),n.usedTimes++),this}remove(t){let e=this.materialCache.get(t);for(let n of e)n.usedTimes--,n.usedTimes===0&&this.shaderCache.delete(n.code);return this.materialCache.delete(t),this}getVertexShaderStage(t){return this._getShaderStage(t.vertexShader)}getFragmentShaderStage(t){return this._getShaderStage(t.fragmentShader)}dispose(){this.shaderCache.clear(),this.materialCache.clear()}_getShaderCacheForMaterial(t){let e=this.materialCache,n=e.get(t);return n===void 0&&(n=new Set,e.set(t,n)),n}_getShaderStage(t){let e=this.shaderCache,n=e.get(t);return n===void 0&&(n=new sd(t),e.set(t,n)),n}},sd=class{constructor(t){this.id=eS++,this.code=t,this.usedTimes=0}};function nS(i){return i===_i||i===Bo||i===ko}function iS(i,t,e,n,s,r){let o=new yr,a=new id,l=new Set,c=[],h=new Map,u=n.logarithmicDepthBuffer,d={MeshDepthMaterial:"depth",MeshDistanceMaterial:"distance",MeshNormalMaterial:"normal",MeshBasicMaterial:"basic",MeshLambertMaterial:"lambert",MeshPhongMaterial:"phong",MeshToonMaterial:"toon",MeshStandardMaterial:"physical",MeshPhysicalMaterial:"physical",MeshMatcapMaterial:"matcap",LineBasicMaterial:"basic",LineDashedMaterial:"dashed",PointsMaterial:"points",ShadowMaterial:"shadow",SpriteMaterial:"sprite"};function f(x){return l.add(x),x===0?"uv":`uv${x}`}function p(x,w,D,R,N,P){let U=R.fog,L=N.geometry,k=x.isMeshStandardMaterial||x.isMeshLambertMaterial||x.isMeshPhongMaterial?R.environment:null,z=x.isMeshStandardMaterial||x.isMeshLambertMaterial&&!x.envMap||x.isMeshPhongMaterial&&!x.envMap,W=t.get(x.envMap||k,z),et=d[x.type],X=n.precision;x.precision!==null&&(X=n.getMaxPrecision(x.precision),X!==x.precision&&It("WebGLProgram.getParameters:",x.precision,"not supported, using",X,"instead."));let Q=L.morphAttributes.position||L.morphAttributes.normal||L.morphAttributes.color,tt=Q!==void 0?Q.length:0,vt=0;L.morphAttributes.position!==void 0&&(vt=1),L.morphAttributes.normal!==void 0&&(vt=2),L.morphAttributes.color!==void 0&&(vt=3);let Ft,J,ut,xt;if(et){let gt=xi[et];Ft=gt.vertexShader,J=gt.fragmentShader}else{Ft=x.vertexShader,J=x.fragmentShader;let gt=a.getVertexShaderStage(x),le=a.getFragmentShaderStage(x);a.update(x,gt,le),ut=gt.id,xt=le.id}let Ct=i.getRenderTarget(),mt=i.state.buffers.depth.getReversed(),Bt=N.isInstancedMesh===!0,Ce=N.isBatchedMesh===!0,Lt=!!x.map,Qt=!!x.matcap,he=!!W,qt=he&&W.isPMREMTexture===!0,Je=!!x.aoMap,Be=!!x.lightMap,wn=!!x.bumpMap&&x.wireframe===!1,we=!!x.normalMap,di=!!x.displacementMap,We=!!x.emissiveMap,Hn=!!x.metalnessMap,Wn=!!x.roughnessMap,$n=x.anisotropy>0,B=x.clearcoat>0,Xn=x.diffuseRoughness>0,ve=x.dispersion>0,be=x.retroreflectivity>0,pt=x.iridescence>0,ke=x.sheen>0,Dt=x.transmission>0,kt=$n&&!!x.anisotropyMap,I=B&&!!x.clearcoatMap,E=B&&!!x.clearcoatNormalMap,G=B&&!!x.clearcoatRoughnessMap,it=Xn&&!!x.diffuseRoughnessMap,j=pt&&!!x.iridescenceMap,ot=pt&&!!x.iridescenceThicknessMap,dt=ke&&!!x.sheenColorMap,Y=ke&&!!x.sheenRoughnessMap,Z=!!x.specularMap,lt=!!x.specularColorMap,F=!!x.specularIntensityMap,K=Dt&&!!x.transmissionMap,q=Dt&&!!x.thicknessMap,ct=!!x.gradientMap,rt=!!x.alphaMap,at=x.alphaTest>0,Et=!!x.alphaHash,Wt=!!x.extensions,st=gi;x.toneMapped&&(Ct===null||Ct.isXRRenderTarget===!0)&&(st=i.toneMapping);let Rt=qt?W.isCompressedCubeTexture?W.image[0].mipmaps:W.mipmaps:null,Gt={shaderID:et,shaderType:x.type,shaderName:x.name,vertexShader:Ft,fragmentShader:J,defines:x.defines,customVertexShaderID:ut,customFragmentShaderID:xt,isRawShaderMaterial:x.isRawShaderMaterial===!0,glslVersion:x.glslVersion,precision:X,batching:Ce,batchingColor:Ce&&N._colorsTexture!==null,instancing:Bt,instancingColor:Bt&&N.instanceColor!==null,instancingMorph:Bt&&N.morphTexture!==null,outputColorSpace:Ct===null?i.outputColorSpace:Ct.isXRRenderTarget===!0?Ct.texture.colorSpace:Jt.workingColorSpace,alphaToCoverage:!!x.alphaToCoverage,map:Lt,matcap:Qt,envMap:he,envMapMode:he&&W.mapping,envMapPMREM:qt,envMapMaxLod:qt?Rt.length-1:null,envMapSize:qt?Rt[0].width:null,aoMap:Je,lightMap:Be,bumpMap:wn,normalMap:we,displacementMap:di,emissiveMap:We,normalMapObjectSpace:we&&x.normalMapType===sm,normalMapTangentSpace:we&&x.normalMapType===Ou,packedNormalMap:we&&x.normalMapType===Ou&&nS(x.normalMap.format),metalnessMap:Hn,roughnessMap:Wn,anisotropy:$n,anisotropyMap:kt,clearcoat:B,clearcoatMap:I,clearcoatNormalMap:E,clearcoatRoughnessMap:G,diffuseRoughness:Xn,diffuseRoughnessMap:it,dispersion:ve,retroreflection:be,iridescence:pt,iridescenceMap:j,iridescenceThicknessMap:ot,sheen:ke,sheenColorMap:dt,sheenRoughnessMap:Y,specularMap:Z,specularColorMap:lt,specularIntensityMap:F,transmission:Dt,transmissionMap:K,thicknessMap:q,gradientMap:ct,opaque:x.transparent===!1&&x.blending===Mr&&x.alphaToCoverage===!1,alphaMap:rt,alphaTest:at,alphaHash:Et,combine:x.combine,mapUv:Lt&&f(x.map.channel),aoMapUv:Je&&f(x.aoMap.channel),lightMapUv:Be&&f(x.lightMap.channel),bumpMapUv:wn&&f(x.bumpMap.channel),normalMapUv:we&&f(x.normalMap.channel),displacementMapUv:di&&f(x.displacementMap.channel),emissiveMapUv:We&&f(x.emissiveMap.channel),metalnessMapUv:Hn&&f(x.metalnessMap.channel),roughnessMapUv:Wn&&f(x.roughnessMap.channel),anisotropyMapUv:kt&&f(x.anisotropyMap.channel),clearcoatMapUv:I&&f(x.clearcoatMap.channel),clearcoatNormalMapUv:E&&f(x.clearcoatNormalMap.channel),clearcoatRoughnessMapUv:G&&f(x.clearcoatRoughnessMap.channel),diffuseRoughnessMapUv:it&&f(x.diffuseRoughnessMap.channel),iridescenceMapUv:j&&f(x.iridescenceMap.channel),iridescenceThicknessMapUv:ot&&f(x.iridescenceThicknessMap.channel),sheenColorMapUv:dt&&f(x.sheenColorMap.channel),sheenRoughnessMapUv:Y&&f(x.sheenRoughnessMap.channel),specularMapUv:Z&&f(x.specularMap.channel),specularColorMapUv:lt&&f(x.specularColorMap.channel),specularIntensityMapUv:F&&f(x.specularIntensityMap.channel),transmissionMapUv:K&&f(x.transmissionMap.channel),thicknessMapUv:q&&f(x.thicknessMap.channel),alphaMapUv:rt&&f(x.alphaMap.channel),vertexTangents:!!L.attributes.tangent&&(we||$n),vertexNormals:!!L.attributes.normal,vertexColors:x.vertexColors,vertexAlphas:x.vertexColors===!0&&!!L.attributes.color&&L.attributes.color.itemSize===4,pointsUvs:N.isPoints===!0&&!!L.attributes.uv&&(Lt||rt),fog:!!U,useFog:x.fog===!0,fogExp2:!!U&&U.isFogExp2,flatShading:x.wireframe===!1&&(x.flatShading===!0||L.attributes.normal===void 0&&we===!1&&(x.isMeshLambertMaterial||x.isMeshPhongMaterial||x.isMeshStandardMaterial||x.isMeshPhysicalMaterial)),sizeAttenuation:x.sizeAttenuation===!0,logarithmicDepthBuffer:u,reversedDepthBuffer:mt,skinning:N.isSkinnedMesh===!0,hasPositionAttribute:L.attributes.position!==void 0,morphTargets:L.morphAttributes.position!==void 0,morphNormals:L.morphAttributes.normal!==void 0,morphColors:L.morphAttributes.color!==void 0,morphTargetsCount:tt,morphTextureStride:vt,numSunLights:w.sun.length,numDirLights:w.directional.length,numPointLights:w.point.length,numSpotLights:w.spot.length,numSpotLightMaps:w.spotLightMap.length,numRectAreaLights:w.rectArea.length,numHemiLights:w.hemi.length,numSunLightShadows:w.sunShadowMap.length,numDirLightShadows:w.directionalShadowMap.length,numPointLightShadows:w.pointShadowMap.length,numSpotLightShadows:w.spotShadowMap.length,numSpotLightShadowsWithMaps:w.numSpotLightShadowsWithMaps,numLightProbes:w.numLightProbes,numLightProbeGrids:P.filter(gt=>gt.texture!==null).length,numClippingPlanes:r.numPlanes,numClipIntersection:r.numIntersection,dithering:x.dithering,shadowMapEnabled:i.shadowMap.enabled&&D.length>0,shadowMapType:i.shadowMap.type,toneMapping:st,decodeVideoTexture:Lt&&x.map.isVideoTexture===!0&&Jt.getTransfer(x.map.colorSpace)===oe,decodeVideoTextureEmissive:We&&x.emissiveMap.isVideoTexture===!0&&Jt.getTransfer(x.emissiveMap.colorSpace)===oe,premultipliedAlpha:x.premultipliedAlpha,doubleSided:x.side===Te,flipSided:x.side===nn,useDepthPacking:x.depthPacking>=0,depthPacking:x.depthPacking||0,index0AttributeName:x.index0AttributeName,extensionClipCullDistance:Wt&&x.extensions.clipCullDistance===!0&&e.has("WEBGL_clip_cull_distance"),extensionMultiDraw:(Wt&&x.extensions.multiDraw===!0||Ce)&&e.has("WEBGL_multi_draw"),rendererExtensionParallelShaderCompile:e.has("KHR_parallel_shader_compile"),customProgramCacheKey:x.customProgramCacheKey()};return Gt.vertexUv1s=l.has(1),Gt.vertexUv2s=l.has(2),Gt.vertexUv3s=l.has(3),l.clear(),Gt}function _(x){let w=[];if(x.shaderID?w.push(x.shaderID):(w.push(x.customVertexShaderID),w.push(x.customFragmentShaderID)),x.defines!==void 0)for(let D in x.defines)w.push(D),w.push(x.defines[D]);return x.isRawShaderMaterial===!1&&(m(w,x),g(w,x),w.push(i.outputColorSpace)),w.push(x.customProgramCacheKey),w.join()}function m(x,w){x.push(w.precision),x.push(w.outputColorSpace),x.push(w.envMapMode),x.push(w.envMapPMREM),x.push(w.envMapMaxLod),x.push(w.envMapSize),x.push(w.mapUv),x.push(w.alphaMapUv),x.push(w.lightMapUv),x.push(w.aoMapUv),x.push(w.bumpMapUv),x.push(w.normalMapUv),x.push(w.displacementMapUv),x.push(w.emissiveMapUv),x.push(w.metalnessMapUv),x.push(w.roughnessMapUv),x.push(w.anisotropyMapUv),x.push(w.clearcoatMapUv),x.push(w.clearcoatNormalMapUv),x.push(w.clearcoatRoughnessMapUv),x.push(w.diffuseRoughnessMapUv),x.push(w.iridescenceMapUv),x.push(w.iridescenceThicknessMapUv),x.push(w.sheenColorMapUv),x.push(w.sheenRoughnessMapUv),x.push(w.specularMapUv),x.push(w.specularColorMapUv),x.push(w.specularIntensityMapUv),x.push(w.transmissionMapUv),x.push(w.thicknessMapUv),x.push(w.combine),x.push(w.fogExp2),x.push(w.sizeAttenuation),x.push(w.morphTargetsCount),x.push(w.numSunLights),x.push(w.numDirLights),x.push(w.numPointLights),x.push(w.numSpotLights),x.push(w.numSpotLightMaps),x.push(w.numHemiLights),x.push(w.numRectAreaLights),x.push(w.numSunLightShadows),x.push(w.numDirLightShadows),x.push(w.numPointLightShadows),x.push(w.numSpotLightShadows),x.push(w.numSpotLightShadowsWithMaps),x.push(w.numLightProbes),x.push(w.numLightProbeGrids),x.push(w.shadowMapType),x.push(w.toneMapping),x.push(w.numClippingPlanes),x.push(w.numClipIntersection),x.push(w.depthPacking)}function g(x,w){o.disableAll(),w.instancing&&o.enable(0),w.instancingColor&&o.enable(1),w.instancingMorph&&o.enable(2),w.matcap&&o.enable(3),w.envMap&&o.enable(4),w.normalMapObjectSpace&&o.enable(5),w.normalMapTangentSpace&&o.enable(6),w.clearcoat&&o.enable(7),w.iridescence&&o.enable(8),w.alphaTest&&o.enable(9),w.vertexColors&&o.enable(10),w.vertexAlphas&&o.enable(11),w.vertexUv1s&&o.enable(12),w.vertexUv2s&&o.enable(13),w.vertexUv3s&&o.enable(14),w.vertexTangents&&o.enable(15),w.anisotropy&&o.enable(16),w.alphaHash&&o.enable(17),w.batching&&o.enable(18),w.dispersion&&o.enable(19),w.retroreflection&&o.enable(24),w.diffuseRoughness&&o.enable(25),w.batchingColor&&o.enable(20),w.gradientMap&&o.enable(21),w.packedNormalMap&&o.enable(22),w.vertexNormals&&o.enable(23),x.push(o.mask),o.disableAll(),w.fog&&o.enable(0),w.useFog&&o.enable(1),w.flatShading&&o.enable(2),w.logarithmicDepthBuffer&&o.enable(3),w.reversedDepthBuffer&&o.enable(4),w.skinning&&o.enable(5),w.morphTargets&&o.enable(6),w.morphNormals&&o.enable(7),w.morphColors&&o.enable(8),w.premultipliedAlpha&&o.enable(9),w.shadowMapEnabled&&o.enable(10),w.doubleSided&&o.enable(11),w.flipSided&&o.enable(12),w.useDepthPacking&&o.enable(13),w.dithering&&o.enable(14),w.transmission&&o.enable(15),w.sheen&&o.enable(16),w.opaque&&o.enable(17),w.pointsUvs&&o.enable(18),w.decodeVideoTexture&&o.enable(19),w.decodeVideoTextureEmissive&&o.enable(20),w.alphaToCoverage&&o.enable(21),w.numLightProbeGrids>0&&o.enable(22),w.hasPositionAttribute&&o.enable(23),x.push(o.mask)}function y(x){let w=d[x.type],D;if(w){let R=xi[w];D=gm.clone(R.uniforms)}else D=x.uniforms;return D}function b(x,w){let D=h.get(w);return D!==void 0?++D.usedTimes:(D=new tS(i,w,x,s),c.push(D),h.set(w,D)),D}function v(x){if(--x.usedTimes===0){let w=c.indexOf(x);c[w]=c[c.length-1],c.pop(),h.delete(x.cacheKey),x.destroy()}}function M(x){a.remove(x)}function A(){a.dispose()}return{getParameters:p,getProgramCacheKey:_,getUniforms:y,acquireProgram:b,releaseProgram:v,releaseShaderCache:M,programs:c,dispose:A}}function sS(){let i=new WeakMap;function t(o){return i.has(o)}function e(o){let a=i.get(o);return a===void 0&&(a={},i.set(o,a)),a}function n(o){i.delete(o)}function s(o,a,l){i.get(o)[a]=l}function r(){i=new WeakMap}return{has:t,get:e,remove:n,update:s,dispose:r}}function rS(i,t){return i.groupOrder!==t.groupOrder?i.groupOrder-t.groupOrder:i.renderOrder!==t.renderOrder?i.renderOrder-t.renderOrder:i.material.id!==t.material.id?i.material.id-t.material.id:i.materialVariant!==t.materialVariant?i.materialVariant-t.materialVariant:i.z!==t.z?i.z-t.z:i.id-t.id}function Um(i,t){return i.groupOrder!==t.groupOrder?i.groupOrder-t.groupOrder:i.renderOrder!==t.renderOrder?i.renderOrder-t.renderOrder:i.z!==t.z?t.z-i.z:i.id-t.id}function Om(){let i=[],t=0,e=[],n=[],s=[];function r(){t=0,e.length=0,n.length=0,s.length=0}function o(d){let f=0;return d.isInstancedMesh&&(f+=2),d.isSkinnedMesh&&(f+=1),f}function a(d,f,p,_,m,g){let y=i[t];return y===void 0?(y={id:d.id,object:d,geometry:f,material:p,materialVariant:o(d),groupOrder:_,renderOrder:d.renderOrder,z:m,group:g},i[t]=y):(y.id=d.id,y.object=d,y.geometry=f,y.material=p,y.materialVariant=o(d),y.groupOrder=_,y.renderOrder=d.renderOrder,y.z=m,y.group=g),t++,y}function l(d,f,p,_,m,g,y){y.reversedDepth===!0&&(m=-m);let b=a(d,f,p,_,m,g);p.transmission>0?n.push(b):p.transparent===!0?s.push(b):e.push(b)}function c(d,f,p,_,m,g){let y=a(d,f,p,_,m,g);p.transmission>0?n.unshift(y):p.transparent===!0?s.unshift(y):e.unshift(y)}function h(d,f){e.length>1&&e.sort(d||rS),n.length>1&&n.sort(f||Um),s.length>1&&s.sort(f||Um)}function u(){for(let d=t,f=i.length;d<f;d++){let p=i[d];if(p.id===null)break;p.id=null,p.object=null,p.geometry=null,p.material=null,p.group=null}}return{opaque:e,transmissive:n,transparent:s,init:r,push:l,unshift:c,finish:u,sort:h}}function oS(){let i=new WeakMap;function t(n,s){let r=i.get(n),o;return r===void 0?(o=new Om,i.set(n,[o])):s>=r.length?(o=new Om,r.push(o)):o=r[s],o}function e(){i=new WeakMap}return{get:t,dispose:e}}function aS(){let i={};return{get:function(t){if(i[t.id]!==void 0)return i[t.id];let e;switch(t.type){case"SunLight":case"DirectionalLight":e={direction:new C,color:new Kt};break;case"SpotLight":e={position:new C,direction:new C,color:new Kt,distance:0,coneCos:0,penumbraCos:0,decay:0};break;case"PointLight":e={position:new C,color:new Kt,distance:0,decay:0};break;case"HemisphereLight":e={direction:new C,skyColor:new Kt,groundColor:new Kt};break;case"RectAreaLight":e={color:new Kt,position:new C,halfWidth:new C,halfHeight:new C};break}return i[t.id]=e,e}}}function lS(){let i={};return{get:function(t){if(i[t.id]!==void 0)return i[t.id];let e;switch(t.type){case"SunLight":case"DirectionalLight":e={shadowIntensity:1,shadowBias:0,shadowNormalBias:0,shadowRadius:1,shadowMapSize:new St};break;case"SpotLight":e={shadowIntensity:1,shadowBias:0,shadowNormalBias:0,shadowRadius:1,shadowMapSize:new St};break;case"PointLight":e={shadowIntensity:1,shadowBias:0,shadowNormalBias:0,shadowRadius:1,shadowMapSize:new St,shadowCameraNear:1,shadowCameraFar:1e3};break}return i[t.id]=e,e}}}var cS=0;function hS(i,t){return(t.castShadow?2:0)-(i.castShadow?2:0)+(t.map?1:0)-(i.map?1:0)}function uS(i){let t=new aS,e=lS(),n={version:0,hash:{sunLength:-1,directionalLength:-1,pointLength:-1,spotLength:-1,rectAreaLength:-1,hemiLength:-1,numSunShadows:-1,numDirectionalShadows:-1,numPointShadows:-1,numSpotShadows:-1,numSpotMaps:-1,numLightProbes:-1},ambient:[0,0,0],probe:[],sun:[],sunShadow:[],sunShadowMap:[],sunShadowMatrix:[],sunShadowCascade:[],directional:[],directionalShadow:[],directionalShadowMap:[],directionalShadowMatrix:[],spot:[],spotLightMap:[],spotShadow:[],spotShadowMap:[],spotLightMatrix:[],rectArea:[],rectAreaLTC1:null,rectAreaLTC2:null,point:[],pointShadow:[],pointShadowMap:[],pointShadowMatrix:[],hemi:[],numSpotLightShadowsWithMaps:0,numLightProbes:0};for(let c=0;c<9;c++)n.probe.push(new C);let s=new C,r=new Pt,o=new Pt;function a(c){let h=0,u=0,d=0;for(let P=0;P<9;P++)n.probe[P].set(0,0,0);let f=0,p=0,_=0,m=0,g=0,y=0,b=0,v=0,M=0,A=0,x=0,w=0,D=0,R=0;c.sort(hS);for(let P=0,U=c.length;P<U;P++){let L=c[P],k=L.color,z=L.intensity,W=L.distance,et=null;if(L.shadow&&L.shadow.map&&(L.shadow.map.texture.format===_i?et=L.shadow.map.texture:et=L.shadow.map.depthTexture||L.shadow.map.texture),L.isAmbientLight)h+=k.r*z,u+=k.g*z,d+=k.b*z;else if(L.isLightProbe){for(let X=0;X<9;X++)n.probe[X].addScaledVector(L.sh.coefficients[X],z);R++}else if(L.isSunLight){let X=t.get(L);if(X.color.copy(L.color).multiplyScalar(L.intensity),L.castShadow){let Q=L.shadow,tt=e.get(L);tt.shadowIntensity=Q.intensity,tt.shadowBias=Q.bias,tt.shadowNormalBias=Q.normalBias,tt.shadowRadius=Q.radius,tt.shadowMapSize.copy(Q.mapSize).multiply(Q.getFrameExtents()),n.sunShadow[p]=tt,n.sunShadowMap[p]=et;let vt=Q.getViewportCount();for(let Ft=0;Ft<vt;Ft++)n.sunShadowMatrix[_+Ft]=Q.getMatrix(Ft),n.sunShadowCascade[_+Ft]=Q._cascadeData[Ft];_+=vt,p++}n.sun[f]=X,f++}else if(L.isDirectionalLight){let X=t.get(L);if(X.color.copy(L.color).multiplyScalar(L.intensity),L.castShadow){let Q=L.shadow,tt=e.get(L);tt.shadowIntensity=Q.intensity,tt.shadowBias=Q.bias,tt.shadowNormalBias=Q.normalBias,tt.shadowRadius=Q.radius,tt.shadowMapSize=Q.mapSize,n.directionalShadow[m]=tt,n.directionalShadowMap[m]=et,n.directionalShadowMatrix[m]=L.shadow.matrix,M++}n.directional[m]=X,m++}else if(L.isSpotLight){let X=t.get(L);X.position.setFromMatrixPosition(L.matrixWorld),X.color.copy(k).multiplyScalar(z),X.distance=W,X.coneCos=Math.cos(L.angle),X.penumbraCos=Math.cos(L.angle*(1-L.penumbra)),X.decay=L.decay,n.spot[y]=X;let Q=L.shadow;if(L.map&&(n.spotLightMap[w]=L.map,w++,Q.updateMatrices(L),L.castShadow&&D++),n.spotLightMatrix[y]=Q.matrix,L.castShadow){let tt=e.get(L);tt.shadowIntensity=Q.intensity,tt.shadowBias=Q.bias,tt.shadowNormalBias=Q.normalBias,tt.shadowRadius=Q.radius,tt.shadowMapSize=Q.mapSize,n.spotShadow[y]=tt,n.spotShadowMap[y]=et,x++}y++}else if(L.isRectAreaLight){let X=t.get(L);X.color.copy(k).multiplyScalar(z),X.halfWidth.set(L.width*.5,0,0),X.halfHeight.set(0,L.height*.5,0),n.rectArea[b]=X,b++}else if(L.isPointLight){let X=t.get(L);if(X.color.copy(L.color).multiplyScalar(L.intensity),X.distance=L.distance,X.decay=L.decay,L.castShadow){let Q=L.shadow,tt=e.get(L);tt.shadowIntensity=Q.intensity,tt.shadowBias=Q.bias,tt.shadowNormalBias=Q.normalBias,tt.shadowRadius=Q.radius,tt.shadowMapSize=Q.mapSize,tt.shadowCameraNear=Q.camera.near,tt.shadowCameraFar=Q.camera.far,n.pointShadow[g]=tt,n.pointShadowMap[g]=et,n.pointShadowMatrix[g]=L.shadow.matrix,A++}n.point[g]=X,g++}else if(L.isHemisphereLight){let X=t.get(L);X.skyColor.copy(L.color).multiplyScalar(z),X.groundColor.copy(L.groundColor).multiplyScalar(z),n.hemi[v]=X,v++}}b>0&&(i.has("OES_texture_float_linear")===!0?(n.rectAreaLTC1=_t.LTC_FLOAT_1,n.rectAreaLTC2=_t.LTC_FLOAT_2):(n.rectAreaLTC1=_t.LTC_HALF_1,n.rectAreaLTC2=_t.LTC_HALF_2)),n.ambient[0]=h,n.ambient[1]=u,n.ambient[2]=d;let N=n.hash;(N.sunLength!==f||N.directionalLength!==m||N.pointLength!==g||N.spotLength!==y||N.rectAreaLength!==b||N.hemiLength!==v||N.numSunShadows!==p||N.numDirectionalShadows!==M||N.numPointShadows!==A||N.numSpotShadows!==x||N.numSpotMaps!==w||N.numLightProbes!==R)&&(n.sun.length=f,n.directional.length=m,n.spot.length=y,n.rectArea.length=b,n.point.length=g,n.hemi.length=v,n.sunShadow.length=p,n.sunShadowMap.length=p,n.sunShadowMatrix.length=_,n.sunShadowCascade.length=_,n.directionalShadow.length=M,n.directionalShadowMap.length=M,n.directionalShadowMatrix.length=M,n.pointShadow.length=A,n.pointShadowMap.length=A,n.pointShadowMatrix.length=A,n.spotShadow.length=x,n.spotShadowMap.length=x,n.spotLightMatrix.length=x+w-D,n.spotLightMap.length=w,n.numSpotLightShadowsWithMaps=D,n.numLightProbes=R,N.sunLength=f,N.directionalLength=m,N.pointLength=g,N.spotLength=y,N.rectAreaLength=b,N.hemiLength=v,N.numSunShadows=p,N.numDirectionalShadows=M,N.numPointShadows=A,N.numSpotShadows=x,N.numSpotMaps=w,N.numLightProbes=R,n.version=cS++)}function l(c,h){let u=0,d=0,f=0,p=0,_=0,m=0,g=h.matrixWorldInverse;for(let y=0,b=c.length;y<b;y++){let v=c[y];if(v.isSunLight){let M=n.sun[u];M.direction.setFromMatrixPosition(v.matrixWorld),M.direction.transformDirection(g),u++}else if(v.isDirectionalLight){let M=n.directional[d];M.direction.setFromMatrixPosition(v.matrixWorld),s.setFromMatrixPosition(v.target.matrixWorld),M.direction.sub(s),M.direction.transformDirection(g),d++}else if(v.isSpotLight){let M=n.spot[p];M.position.setFromMatrixPosition(v.matrixWorld),M.position.applyMatrix4(g),M.direction.setFromMatrixPosition(v.matrixWorld),s.setFromMatrixPosition(v.target.matrixWorld),M.direction.sub(s),M.direction.transformDirection(g),p++}else if(v.isRectAreaLight){let M=n.rectArea[_];M.position.setFromMatrixPosition(v.matrixWorld),M.position.applyMatrix4(g),o.identity(),r.copy(v.matrixWorld),r.premultiply(g),o.extractRotation(r),M.halfWidth.set(v.width*.5,0,0),M.halfHeight.set(0,v.height*.5,0),M.halfWidth.applyMatrix4(o),M.halfHeight.applyMatrix4(o),_++}else if(v.isPointLight){let M=n.point[f];M.position.setFromMatrixPosition(v.matrixWorld),M.position.applyMatrix4(g),f++}else if(v.isHemisphereLight){let M=n.hemi[m];M.direction.setFromMatrixPosition(v.matrixWorld),M.direction.transformDirection(g),m++}}}return{setup:a,setupView:l,state:n}}function Bm(i){let t=new uS(i),e=[],n=[],s=[];function r(u){h.camera=u,e.length=0,n.length=0,s.length=0}function o(u){u.isLightProbeGrid?s.push(u):e.push(u)}function a(u){n.push(u)}function l(){t.setup(e),s.sort((u,d)=>u.priority-d.priority||u.id-d.id)}function c(u){t.setupView(e,u)}let h={lightsArray:e,shadowsArray:n,lightProbeGridArray:s,camera:null,lights:t,transmissionRenderTarget:{},textureUnits:0};return{init:r,state:h,setupLights:l,setupLightsView:c,pushLight:o,pushShadow:a}}function dS(i){let t=new WeakMap;function e(s,r=0){let o=t.get(s),a;return o===void 0?(a=new Bm(i),t.set(s,[a])):r>=o.length?(a=new Bm(i),o.push(a)):a=o[r],a}function n(){t=new WeakMap}return{get:e,dispose:n}}var fS=`void main() {
	gl_Position = vec4( position, 1.0 );
}`,pS=`uniform sampler2D shadow_pass;
uniform vec2 resolution;
uniform float radius;
void main() {
	const float samples = float( VSM_SAMPLES );
	float mean = 0.0;
	float squared_mean = 0.0;
	float uvStride = samples <= 1.0 ? 0.0 : 2.0 / ( samples - 1.0 );
	float uvStart = samples <= 1.0 ? 0.0 : - 1.0;
	for ( float i = 0.0; i < samples; i ++ ) {
		float uvOffset = uvStart + i * uvStride;
		#ifdef HORIZONTAL_PASS
			vec2 distribution = texture2D( shadow_pass, ( gl_FragCoord.xy + vec2( uvOffset, 0.0 ) * radius ) / resolution ).rg;
			mean += distribution.x;
			squared_mean += distribution.y * distribution.y + distribution.x * distribution.x;
		#else
			float depth = texture2D( shadow_pass, ( gl_FragCoord.xy + vec2( 0.0, uvOffset ) * radius ) / resolution ).r;
			mean += depth;
			squared_mean += depth * depth;
		#endif
	}
	mean = mean / samples;
	squared_mean = squared_mean / samples;
	float std_dev = sqrt( max( 0.0, squared_mean - mean * mean ) );
	gl_FragColor = vec4( mean, std_dev, 0.0, 1.0 );
}`,mS=[new C(1,0,0),new C(-1,0,0),new C(0,1,0),new C(0,-1,0),new C(0,0,1),new C(0,0,-1)],gS=[new C(0,-1,0),new C(0,-1,0),new C(0,0,1),new C(0,0,-1),new C(0,-1,0),new C(0,-1,0)],km=new Pt,zo=new C,ju=new C;function _S(i,t,e){let n=new Ls,s=new St,r=new St,o=new de,a=new El,l=new Tl,c={},h=e.maxTextureSize,u={[oi]:nn,[nn]:oi,[Te]:Te},d=new Ie({defines:{VSM_SAMPLES:8},uniforms:{shadow_pass:{value:null},resolution:{value:new St},radius:{value:4}},vertexShader:fS,fragmentShader:pS}),f=d.clone();f.defines.HORIZONTAL_PASS=1;let p=new Me;p.setAttribute("position",new Ht(new Float32Array([-1,-1,.5,3,-1,.5,-1,3,.5]),3));let _=new Ee(p,d),m=this;this.enabled=!1,this.autoUpdate=!0,this.needsUpdate=!1,this.type=Io;let g=this.type;this.render=function(A,x,w){if(m.enabled===!1||m.autoUpdate===!1&&m.needsUpdate===!1||A.length===0)return;this.type===Fp&&(It("WebGLShadowMap: PCFSoftShadowMap has been removed. Using PCFShadowMap instead."),this.type=Io);let D=i.getRenderTarget(),R=i.getActiveCubeFace(),N=i.getActiveMipmapLevel(),P=i.state;P.setBlending(Ds),P.buffers.depth.getReversed()===!0?P.buffers.color.setClear(0,0,0,0):P.buffers.color.setClear(1,1,1,1),P.buffers.depth.setTest(!0),P.setScissorTest(!1);let U=g!==this.type;U&&x.traverse(function(L){L.material&&(Array.isArray(L.material)?L.material.forEach(k=>k.needsUpdate=!0):L.material.needsUpdate=!0)});for(let L=0,k=A.length;L<k;L++){let z=A[L],W=z.shadow;if(W===void 0){It("WebGLShadowMap:",z,"has no shadow.");continue}if(W.autoUpdate===!1&&W.needsUpdate===!1)continue;s.copy(W.mapSize);let et=W.getFrameExtents();s.multiply(et),r.copy(W.mapSize),(s.x>h||s.y>h)&&(s.x>h&&(r.x=Math.floor(h/et.x),s.x=r.x*et.x,W.mapSize.x=r.x),s.y>h&&(r.y=Math.floor(h/et.y),s.y=r.y*et.y,W.mapSize.y=r.y));let X=i.state.buffers.depth.getReversed();if(W.camera._reversedDepth=X,W.map===null||U===!0){if(W.map!==null&&(W.map.depthTexture!==null&&(W.map.depthTexture.dispose(),W.map.depthTexture=null),W.map.dispose()),this.type===Sr){if(z.isPointLight){It("WebGLShadowMap: VSM shadow maps are not supported for PointLights. Use PCF or BasicShadowMap instead.");continue}W.map=new Un(s.x,s.y,{format:_i,type:li,minFilter:yn,magFilter:yn,generateMipmaps:!1}),W.map.texture.name=z.name+".shadowMap",W.map.depthTexture=new Fi(s.x,s.y,Rn),W.map.depthTexture.name=z.name+".shadowMapDepth",W.map.depthTexture.format=Li,W.map.depthTexture.compareFunction=null,W.map.depthTexture.minFilter=ye,W.map.depthTexture.magFilter=ye}else z.isPointLight?(W.map=new Go(s.x),W.map.depthTexture=new Mo(s.x,ai)):(W.map=new Un(s.x,s.y),W.map.depthTexture=new Fi(s.x,s.y,ai)),W.map.depthTexture.name=z.name+".shadowMap",W.map.depthTexture.format=Li,this.type===Io?(W.map.depthTexture.compareFunction=X?ku:Bu,W.map.depthTexture.minFilter=yn,W.map.depthTexture.magFilter=yn):(W.map.depthTexture.compareFunction=null,W.map.depthTexture.minFilter=ye,W.map.depthTexture.magFilter=ye);W.camera.updateProjectionMatrix()}W.map.isWebGLCubeRenderTarget!==!0&&(W.map.width!==s.x||W.map.height!==s.y)&&W.map.setSize(s.x,s.y);let Q=W.map.isWebGLCubeRenderTarget?6:W.getViewportCount();z.isPointLight!==!0&&W.updateMatrices(z,w);let tt=(W.camera.layers.mask&4294967294)!==0?W.camera.layers:w.layers;for(let vt=0;vt<Q;vt++){let Ft=W.getCamera(vt);if(z.isPointLight){let J=W.camera,ut=W.matrix,xt=z.distance||J.far;xt!==J.far&&(J.far=xt,J.updateProjectionMatrix()),zo.setFromMatrixPosition(z.matrixWorld),J.position.copy(zo),ju.copy(J.position),ju.add(mS[vt]),J.up.copy(gS[vt]),J.lookAt(ju),J.updateMatrixWorld(),ut.makeTranslation(-zo.x,-zo.y,-zo.z),km.multiplyMatrices(J.projectionMatrix,J.matrixWorldInverse),W._frustum.setFromProjectionMatrix(km,J.coordinateSystem,J.reversedDepth)}if(W.map.isWebGLCubeRenderTarget)i.setRenderTarget(W.map,vt),i.clear();else{vt===0&&(i.setRenderTarget(W.map),i.clear());let J=W.getViewport(vt);o.set(r.x*J.x,r.y*J.y,r.x*J.z,r.y*J.w),P.viewport(o)}n=W.getFrustum(vt),v(x,w,Ft,z,tt,this.type)}W.isPointLightShadow!==!0&&this.type===Sr&&y(W,w),W.needsUpdate=!1}g=this.type,m.needsUpdate=!1,i.setRenderTarget(D,R,N)};function y(A,x){let w=t.update(_);d.defines.VSM_SAMPLES!==A.blurSamples&&(d.defines.VSM_SAMPLES=A.blurSamples,f.defines.VSM_SAMPLES=A.blurSamples,d.needsUpdate=!0,f.needsUpdate=!0),A.mapPass===null?A.mapPass=new Un(s.x,s.y,{format:_i,type:li}):(A.mapPass.width!==A.map.width||A.mapPass.height!==A.map.height)&&A.mapPass.setSize(A.map.width,A.map.height),d.uniforms.shadow_pass.value=A.map.depthTexture,d.uniforms.resolution.value.set(A.map.width,A.map.height),d.uniforms.radius.value=A.radius,i.setRenderTarget(A.mapPass),i.clear(),i.renderBufferDirect(x,null,w,d,_,null),f.uniforms.shadow_pass.value=A.mapPass.texture,f.uniforms.resolution.value.set(A.map.width,A.map.height),f.uniforms.radius.value=A.radius,i.setRenderTarget(A.map),i.clear(),i.renderBufferDirect(x,null,w,f,_,null)}function b(A,x,w,D){let R=null,N=w.isPointLight===!0?A.customDistanceMaterial:A.customDepthMaterial;if(N!==void 0)R=N;else if(R=w.isPointLight===!0?l:a,i.localClippingEnabled&&x.clipShadows===!0&&Array.isArray(x.clippingPlanes)&&x.clippingPlanes.length!==0||x.displacementMap&&x.displacementScale!==0||x.alphaMap&&x.alphaTest>0||x.map&&x.alphaTest>0||x.alphaToCoverage===!0){let P=R.uuid,U=x.uuid,L=c[P];L===void 0&&(L={},c[P]=L);let k=L[U];k===void 0&&(k=R.clone(),L[U]=k,x.addEventListener("dispose",M)),R=k}if(R.visible=x.visible,R.wireframe=x.wireframe,D===Sr?R.side=x.shadowSide!==null?x.shadowSide:x.side:R.side=x.shadowSide!==null?x.shadowSide:u[x.side],R.alphaMap=x.alphaMap,R.alphaTest=x.alphaToCoverage===!0?.5:x.alphaTest,R.map=x.map,R.clipShadows=x.clipShadows,R.clippingPlanes=x.clippingPlanes,R.clipIntersection=x.clipIntersection,R.displacementMap=x.displacementMap,R.displacementScale=x.displacementScale,R.displacementBias=x.displacementBias,R.wireframeLinewidth=x.wireframeLinewidth,R.linewidth=x.linewidth,w.isPointLight===!0&&R.isMeshDistanceMaterial===!0){let P=i.properties.get(R);P.light=w}return R}function v(A,x,w,D,R,N){if(A.visible===!1)return;if(A.layers.test(R)&&(A.isMesh||A.isLine||A.isPoints)&&(A.castShadow||A.receiveShadow&&N===Sr)&&(!A.frustumCulled||A.intersectsFrustum(n))){A.modelViewMatrix.multiplyMatrices(w.matrixWorldInverse,A.matrixWorld);let L=t.update(A),k=A.material;if(Array.isArray(k)){let z=L.groups;for(let W=0,et=z.length;W<et;W++){let X=z[W],Q=k[X.materialIndex];if(Q&&Q.visible){let tt=b(A,Q,D,N);A.onBeforeShadow(i,A,x,w,L,tt,X),i.renderBufferDirect(w,null,L,tt,A,X),A.onAfterShadow(i,A,x,w,L,tt,X)}}}else if(k.visible){let z=b(A,k,D,N);A.onBeforeShadow(i,A,x,w,L,z,null),i.renderBufferDirect(w,null,L,z,A,null),A.onAfterShadow(i,A,x,w,L,z,null)}}let U=A.children;for(let L=0,k=U.length;L<k;L++)v(U[L],x,w,D,R,N)}function M(A){A.target.removeEventListener("dispose",M);for(let w in c){let D=c[w],R=A.target.uuid;R in D&&(D[R].dispose(),delete D[R])}}}function yS(i,t){function e(){let F=!1,K=new de,q=null,ct=new de(0,0,0,0);return{setMask:function(rt){q!==rt&&!F&&(i.colorMask(rt,rt,rt,rt),q=rt)},setLocked:function(rt){F=rt},setClear:function(rt,at,Et,Wt,st){st===!0&&(rt*=Wt,at*=Wt,Et*=Wt),K.set(rt,at,Et,Wt),ct.equals(K)===!1&&(i.clearColor(rt,at,Et,Wt),ct.copy(K))},reset:function(){F=!1,q=null,ct.set(-1,0,0,0)}}}function n(){let F=!1,K=!1,q=null,ct=null,rt=null;return{setReversed:function(at){if(K!==at){let Et=t.get("EXT_clip_control");at?Et.clipControlEXT(Et.LOWER_LEFT_EXT,Et.ZERO_TO_ONE_EXT):Et.clipControlEXT(Et.LOWER_LEFT_EXT,Et.NEGATIVE_ONE_TO_ONE_EXT),K=at;let Wt=rt;rt=null,this.setClear(Wt)}},getReversed:function(){return K},setTest:function(at){at?mt(i.DEPTH_TEST):Bt(i.DEPTH_TEST)},setMask:function(at){q!==at&&!F&&(i.depthMask(at),q=at)},setFunc:function(at){if(K&&(at=pm[at]),ct!==at){switch(at){case al:i.depthFunc(i.NEVER);break;case ll:i.depthFunc(i.ALWAYS);break;case cl:i.depthFunc(i.LESS);break;case fr:i.depthFunc(i.LEQUAL);break;case hl:i.depthFunc(i.EQUAL);break;case ul:i.depthFunc(i.GEQUAL);break;case dl:i.depthFunc(i.GREATER);break;case fl:i.depthFunc(i.NOTEQUAL);break;default:i.depthFunc(i.LEQUAL)}ct=at}},setLocked:function(at){F=at},setClear:function(at){rt!==at&&(rt=at,K&&(at=1-at),i.clearDepth(at))},reset:function(){F=!1,q=null,ct=null,rt=null,K=!1}}}function s(){let F=!1,K=null,q=null,ct=null,rt=null,at=null,Et=null,Wt=null,st=null;return{setTest:function(Rt){F||(Rt?mt(i.STENCIL_TEST):Bt(i.STENCIL_TEST))},setMask:function(Rt){K!==Rt&&!F&&(i.stencilMask(Rt),K=Rt)},setFunc:function(Rt,Gt,gt){(q!==Rt||ct!==Gt||rt!==gt)&&(i.stencilFunc(Rt,Gt,gt),q=Rt,ct=Gt,rt=gt)},setOp:function(Rt,Gt,gt){(at!==Rt||Et!==Gt||Wt!==gt)&&(i.stencilOp(Rt,Gt,gt),at=Rt,Et=Gt,Wt=gt)},setLocked:function(Rt){F=Rt},setClear:function(Rt){st!==Rt&&(i.clearStencil(Rt),st=Rt)},reset:function(){F=!1,K=null,q=null,ct=null,rt=null,at=null,Et=null,Wt=null,st=null}}}let r=new e,o=new n,a=new s,l={},c=new WeakMap,h={},u={},d={},f=new WeakMap,p=[],_=null,m=!1,g=null,y=null,b=null,v=null,M=null,A=null,x=null,w=new Kt(0,0,0),D=0,R=!1,N=null,P=null,U=null,L=null,k=null,z=i.getParameter(i.MAX_COMBINED_TEXTURE_IMAGE_UNITS),W=!1,et=0,X=i.getParameter(i.VERSION);X.indexOf("WebGL")!==-1?(et=parseFloat(/^WebGL (\d)/.exec(X)[1]),W=et>=1):X.indexOf("OpenGL ES")!==-1&&(et=parseFloat(/^OpenGL ES (\d)/.exec(X)[1]),W=et>=2);let Q=null,tt={},vt=i.getParameter(i.SCISSOR_BOX),Ft=i.getParameter(i.VIEWPORT),J=new de().fromArray(vt),ut=new de().fromArray(Ft);function xt(F,K,q,ct){let rt=new Uint8Array(4),at=i.createTexture();i.bindTexture(F,at),i.texParameteri(F,i.TEXTURE_MIN_FILTER,i.NEAREST),i.texParameteri(F,i.TEXTURE_MAG_FILTER,i.NEAREST);for(let Et=0;Et<q;Et++)F===i.TEXTURE_3D||F===i.TEXTURE_2D_ARRAY?i.texImage3D(K,0,i.RGBA,1,1,ct,0,i.RGBA,i.UNSIGNED_BYTE,rt):i.texImage2D(K+Et,0,i.RGBA,1,1,0,i.RGBA,i.UNSIGNED_BYTE,rt);return at}let Ct={};Ct[i.TEXTURE_2D]=xt(i.TEXTURE_2D,i.TEXTURE_2D,1),Ct[i.TEXTURE_CUBE_MAP]=xt(i.TEXTURE_CUBE_MAP,i.TEXTURE_CUBE_MAP_POSITIVE_X,6),Ct[i.TEXTURE_2D_ARRAY]=xt(i.TEXTURE_2D_ARRAY,i.TEXTURE_2D_ARRAY,1,1),Ct[i.TEXTURE_3D]=xt(i.TEXTURE_3D,i.TEXTURE_3D,1,1),r.setClear(0,0,0,1),o.setClear(1),a.setClear(0),mt(i.DEPTH_TEST),o.setFunc(fr),wn(!1),we(gu),mt(i.CULL_FACE),Je(Ds);function mt(F){h[F]!==!0&&(i.enable(F),h[F]=!0)}function Bt(F){h[F]!==!1&&(i.disable(F),h[F]=!1)}function Ce(F,K){return d[F]!==K?(i.bindFramebuffer(F,K),d[F]=K,F===i.DRAW_FRAMEBUFFER&&(d[i.FRAMEBUFFER]=K),F===i.FRAMEBUFFER&&(d[i.DRAW_FRAMEBUFFER]=K),!0):!1}function Lt(F,K){let q=p,ct=!1;if(F){q=f.get(K),q===void 0&&(q=[],f.set(K,q));let rt=F.textures;if(q.length!==rt.length||q[0]!==i.COLOR_ATTACHMENT0){for(let at=0,Et=rt.length;at<Et;at++)q[at]=i.COLOR_ATTACHMENT0+at;q.length=rt.length,ct=!0}}else q[0]!==i.BACK&&(q[0]=i.BACK,ct=!0);ct&&i.drawBuffers(q)}function Qt(F){return _!==F?(i.useProgram(F),_=F,!0):!1}let he={[Ns]:i.FUNC_ADD,[Op]:i.FUNC_SUBTRACT,[Bp]:i.FUNC_REVERSE_SUBTRACT};he[kp]=i.MIN,he[zp]=i.MAX;let qt={[Vp]:i.ZERO,[Gp]:i.ONE,[Hp]:i.SRC_COLOR,[vu]:i.SRC_ALPHA,[Zp]:i.SRC_ALPHA_SATURATE,[qp]:i.DST_COLOR,[$p]:i.DST_ALPHA,[Wp]:i.ONE_MINUS_SRC_COLOR,[bu]:i.ONE_MINUS_SRC_ALPHA,[Yp]:i.ONE_MINUS_DST_COLOR,[Xp]:i.ONE_MINUS_DST_ALPHA,[Jp]:i.CONSTANT_COLOR,[Kp]:i.ONE_MINUS_CONSTANT_COLOR,[jp]:i.CONSTANT_ALPHA,[Qp]:i.ONE_MINUS_CONSTANT_ALPHA};function Je(F,K,q,ct,rt,at,Et,Wt,st,Rt){if(F===Ds){m===!0&&(Bt(i.BLEND),m=!1);return}if(m===!1&&(mt(i.BLEND),m=!0),F!==Up){if(F!==g||Rt!==R){if((y!==Ns||M!==Ns)&&(i.blendEquation(i.FUNC_ADD),y=Ns,M=Ns),Rt)switch(F){case Mr:i.blendFuncSeparate(i.ONE,i.ONE_MINUS_SRC_ALPHA,i.ONE,i.ONE_MINUS_SRC_ALPHA);break;case _u:i.blendFunc(i.ONE,i.ONE);break;case yu:i.blendFuncSeparate(i.ZERO,i.ONE_MINUS_SRC_COLOR,i.ZERO,i.ONE);break;case xu:i.blendFuncSeparate(i.DST_COLOR,i.ONE_MINUS_SRC_ALPHA,i.ZERO,i.ONE);break;default:Nt("WebGLState: Invalid blending: ",F);break}else switch(F){case Mr:i.blendFuncSeparate(i.SRC_ALPHA,i.ONE_MINUS_SRC_ALPHA,i.ONE,i.ONE_MINUS_SRC_ALPHA);break;case _u:i.blendFuncSeparate(i.SRC_ALPHA,i.ONE,i.ONE,i.ONE);break;case yu:Nt("WebGLState: SubtractiveBlending requires material.premultipliedAlpha = true");break;case xu:Nt("WebGLState: MultiplyBlending requires material.premultipliedAlpha = true");break;default:Nt("WebGLState: Invalid blending: ",F);break}b=null,v=null,A=null,x=null,w.set(0,0,0),D=0,g=F,R=Rt}return}rt=rt||K,at=at||q,Et=Et||ct,(K!==y||rt!==M)&&(i.blendEquationSeparate(he[K],he[rt]),y=K,M=rt),(q!==b||ct!==v||at!==A||Et!==x)&&(i.blendFuncSeparate(qt[q],qt[ct],qt[at],qt[Et]),b=q,v=ct,A=at,x=Et),(Wt.equals(w)===!1||st!==D)&&(i.blendColor(Wt.r,Wt.g,Wt.b,st),w.copy(Wt),D=st),g=F,R=!1}function Be(F,K){F.side===Te?Bt(i.CULL_FACE):mt(i.CULL_FACE);let q=F.side===nn;K&&(q=!q),wn(q),F.blending===Mr&&F.transparent===!1?Je(Ds):Je(F.blending,F.blendEquation,F.blendSrc,F.blendDst,F.blendEquationAlpha,F.blendSrcAlpha,F.blendDstAlpha,F.blendColor,F.blendAlpha,F.premultipliedAlpha),o.setFunc(F.depthFunc),o.setTest(F.depthTest),o.setMask(F.depthWrite),r.setMask(F.colorWrite);let ct=F.stencilWrite;a.setTest(ct),ct&&(a.setMask(F.stencilWriteMask),a.setFunc(F.stencilFunc,F.stencilRef,F.stencilFuncMask),a.setOp(F.stencilFail,F.stencilZFail,F.stencilZPass)),We(F.polygonOffset,F.polygonOffsetFactor,F.polygonOffsetUnits),F.alphaToCoverage===!0?mt(i.SAMPLE_ALPHA_TO_COVERAGE):Bt(i.SAMPLE_ALPHA_TO_COVERAGE)}function wn(F){N!==F&&(F?i.frontFace(i.CW):i.frontFace(i.CCW),N=F)}function we(F){F!==Dp?(mt(i.CULL_FACE),F!==P&&(F===gu?i.cullFace(i.BACK):F===Np?i.cullFace(i.FRONT):i.cullFace(i.FRONT_AND_BACK))):Bt(i.CULL_FACE),P=F}function di(F){F!==U&&(W&&i.lineWidth(F),U=F)}function We(F,K,q){F?(mt(i.POLYGON_OFFSET_FILL),(L!==K||k!==q)&&(L=K,k=q,o.getReversed()&&(K=-K,q=-q),i.polygonOffset(K,q))):Bt(i.POLYGON_OFFSET_FILL)}function Hn(F){F?mt(i.SCISSOR_TEST):Bt(i.SCISSOR_TEST)}function Wn(F){F===void 0&&(F=i.TEXTURE0+z-1),Q!==F&&(i.activeTexture(F),Q=F)}function $n(F,K,q){q===void 0&&(Q===null?q=i.TEXTURE0+z-1:q=Q);let ct=tt[q];ct===void 0&&(ct={type:void 0,texture:void 0},tt[q]=ct),(ct.type!==F||ct.texture!==K)&&(Q!==q&&(i.activeTexture(q),Q=q),i.bindTexture(F,K||Ct[F]),ct.type=F,ct.texture=K)}function B(){let F=tt[Q];F!==void 0&&F.type!==void 0&&(i.bindTexture(F.type,null),F.type=void 0,F.texture=void 0)}function Xn(){try{i.compressedTexImage2D(...arguments)}catch(F){Nt("WebGLState:",F)}}function ve(){try{i.compressedTexImage3D(...arguments)}catch(F){Nt("WebGLState:",F)}}function be(){try{i.texSubImage2D(...arguments)}catch(F){Nt("WebGLState:",F)}}function pt(){try{i.texSubImage3D(...arguments)}catch(F){Nt("WebGLState:",F)}}function ke(){try{i.compressedTexSubImage2D(...arguments)}catch(F){Nt("WebGLState:",F)}}function Dt(){try{i.compressedTexSubImage3D(...arguments)}catch(F){Nt("WebGLState:",F)}}function kt(){try{i.texStorage2D(...arguments)}catch(F){Nt("WebGLState:",F)}}function I(){try{i.texStorage3D(...arguments)}catch(F){Nt("WebGLState:",F)}}function E(){try{i.texImage2D(...arguments)}catch(F){Nt("WebGLState:",F)}}function G(){try{i.texImage3D(...arguments)}catch(F){Nt("WebGLState:",F)}}function it(F){return u[F]!==void 0?u[F]:i.getParameter(F)}function j(F,K){u[F]!==K&&(i.pixelStorei(F,K),u[F]=K)}function ot(F){J.equals(F)===!1&&(i.scissor(F.x,F.y,F.z,F.w),J.copy(F))}function dt(F){ut.equals(F)===!1&&(i.viewport(F.x,F.y,F.z,F.w),ut.copy(F))}function Y(F,K){let q=c.get(K);q===void 0&&(q=new WeakMap,c.set(K,q));let ct=q.get(F);ct===void 0&&(ct=i.getUniformBlockIndex(K,F.name),i.uniformBlockBinding(K,ct,ct),q.set(F,ct))}function Z(F,K,q){let rt=c.get(K).get(F);l[rt]!==q&&(i.bindBufferBase(i.UNIFORM_BUFFER,rt,q),l[rt]=q)}function lt(){i.disable(i.BLEND),i.disable(i.CULL_FACE),i.disable(i.DEPTH_TEST),i.disable(i.POLYGON_OFFSET_FILL),i.disable(i.SCISSOR_TEST),i.disable(i.STENCIL_TEST),i.disable(i.SAMPLE_ALPHA_TO_COVERAGE),i.blendEquation(i.FUNC_ADD),i.blendFunc(i.ONE,i.ZERO),i.blendFuncSeparate(i.ONE,i.ZERO,i.ONE,i.ZERO),i.blendColor(0,0,0,0),i.colorMask(!0,!0,!0,!0),i.clearColor(0,0,0,0),i.depthMask(!0),i.depthFunc(i.LESS),o.setReversed(!1),i.clearDepth(1),i.stencilMask(4294967295),i.stencilFunc(i.ALWAYS,0,4294967295),i.stencilOp(i.KEEP,i.KEEP,i.KEEP),i.clearStencil(0),i.cullFace(i.BACK),i.frontFace(i.CCW),i.polygonOffset(0,0),i.activeTexture(i.TEXTURE0),i.bindFramebuffer(i.FRAMEBUFFER,null),i.bindFramebuffer(i.DRAW_FRAMEBUFFER,null),i.bindFramebuffer(i.READ_FRAMEBUFFER,null),i.useProgram(null),i.lineWidth(1),i.scissor(0,0,i.canvas.width,i.canvas.height),i.viewport(0,0,i.canvas.width,i.canvas.height),i.pixelStorei(i.PACK_ALIGNMENT,4),i.pixelStorei(i.UNPACK_ALIGNMENT,4),i.pixelStorei(i.UNPACK_FLIP_Y_WEBGL,!1),i.pixelStorei(i.UNPACK_PREMULTIPLY_ALPHA_WEBGL,!1),i.pixelStorei(i.UNPACK_COLORSPACE_CONVERSION_WEBGL,i.BROWSER_DEFAULT_WEBGL),i.pixelStorei(i.PACK_ROW_LENGTH,0),i.pixelStorei(i.PACK_SKIP_PIXELS,0),i.pixelStorei(i.PACK_SKIP_ROWS,0),i.pixelStorei(i.UNPACK_ROW_LENGTH,0),i.pixelStorei(i.UNPACK_IMAGE_HEIGHT,0),i.pixelStorei(i.UNPACK_SKIP_PIXELS,0),i.pixelStorei(i.UNPACK_SKIP_ROWS,0),i.pixelStorei(i.UNPACK_SKIP_IMAGES,0),h={},u={},Q=null,tt={},d={},l={},f=new WeakMap,p=[],_=null,m=!1,g=null,y=null,b=null,v=null,M=null,A=null,x=null,w=new Kt(0,0,0),D=0,R=!1,N=null,P=null,U=null,L=null,k=null,J.set(0,0,i.canvas.width,i.canvas.height),ut.set(0,0,i.canvas.width,i.canvas.height),r.reset(),o.reset(),a.reset()}return{buffers:{color:r,depth:o,stencil:a},enable:mt,disable:Bt,bindFramebuffer:Ce,drawBuffers:Lt,useProgram:Qt,setBlending:Je,setMaterial:Be,setFlipSided:wn,setCullFace:we,setLineWidth:di,setPolygonOffset:We,setScissorTest:Hn,activeTexture:Wn,bindTexture:$n,unbindTexture:B,compressedTexImage2D:Xn,compressedTexImage3D:ve,texImage2D:E,texImage3D:G,pixelStorei:j,getParameter:it,updateUBOMapping:Y,uniformBlockBinding:Z,texStorage2D:kt,texStorage3D:I,texSubImage2D:be,texSubImage3D:pt,compressedTexSubImage2D:ke,compressedTexSubImage3D:Dt,scissor:ot,viewport:dt,reset:lt}}function xS(i,t,e,n,s,r,o){let a=t.has("WEBGL_multisampled_render_to_texture")?t.get("WEBGL_multisampled_render_to_texture"):null,l=typeof navigator>"u"?!1:/OculusBrowser/g.test(navigator.userAgent),c=new St,h=new WeakMap,u=new Set,d,f=new WeakMap,p=new Set,_=new FinalizationRegistry(I=>p.delete(I)),m=!1;try{m=typeof OffscreenCanvas<"u"&&new OffscreenCanvas(1,1).getContext("2d")!==null}catch{}function g(I,E){return m?new OffscreenCanvas(I,E):po("canvas")}function y(I,E,G){let it=1,j=kt(I);if((j.width>G||j.height>G)&&(it=G/Math.max(j.width,j.height)),it<1)if(typeof HTMLImageElement<"u"&&I instanceof HTMLImageElement||typeof HTMLCanvasElement<"u"&&I instanceof HTMLCanvasElement||typeof ImageBitmap<"u"&&I instanceof ImageBitmap||typeof VideoFrame<"u"&&I instanceof VideoFrame){let ot=Math.floor(it*j.width),dt=Math.floor(it*j.height);d===void 0&&(d=g(ot,dt));let Y=E?g(ot,dt):d;return Y.width=ot,Y.height=dt,Y.getContext("2d").drawImage(I,0,0,ot,dt),It("WebGLRenderer: Texture has been resized from ("+j.width+"x"+j.height+") to ("+ot+"x"+dt+")."),Y}else return"data"in I&&It("WebGLRenderer: Image in DataTexture is too big ("+j.width+"x"+j.height+")."),I;return I}function b(I){return I.generateMipmaps}function v(I){i.generateMipmap(I)}function M(I){return I.isWebGLCubeRenderTarget?i.TEXTURE_CUBE_MAP:I.isWebGL3DRenderTarget?i.TEXTURE_3D:I.isWebGLArrayRenderTarget||I.isCompressedArrayTexture?i.TEXTURE_2D_ARRAY:i.TEXTURE_2D}function A(I,E,G,it,j,ot=!1){if(I!==null){if(i[I]!==void 0)return i[I];It("WebGLRenderer: Attempt to use non-existing WebGL internal format '"+I+"'")}let dt;it&&(dt=t.get("EXT_texture_norm16"),dt||It("WebGLRenderer: Unable to use normalized textures without EXT_texture_norm16 extension"));let Y=E;if(E===i.RED&&(G===i.FLOAT&&(Y=i.R32F),G===i.HALF_FLOAT&&(Y=i.R16F),G===i.UNSIGNED_BYTE&&(Y=i.R8),G===i.UNSIGNED_SHORT&&dt&&(Y=dt.R16_EXT),G===i.SHORT&&dt&&(Y=dt.R16_SNORM_EXT)),E===i.RED_INTEGER&&(G===i.UNSIGNED_BYTE&&(Y=i.R8UI),G===i.UNSIGNED_SHORT&&(Y=i.R16UI),G===i.UNSIGNED_INT&&(Y=i.R32UI),G===i.BYTE&&(Y=i.R8I),G===i.SHORT&&(Y=i.R16I),G===i.INT&&(Y=i.R32I)),E===i.RG&&(G===i.FLOAT&&(Y=i.RG32F),G===i.HALF_FLOAT&&(Y=i.RG16F),G===i.UNSIGNED_BYTE&&(Y=i.RG8),G===i.UNSIGNED_SHORT&&dt&&(Y=dt.RG16_EXT),G===i.SHORT&&dt&&(Y=dt.RG16_SNORM_EXT)),E===i.RG_INTEGER&&(G===i.UNSIGNED_BYTE&&(Y=i.RG8UI),G===i.UNSIGNED_SHORT&&(Y=i.RG16UI),G===i.UNSIGNED_INT&&(Y=i.RG32UI),G===i.BYTE&&(Y=i.RG8I),G===i.SHORT&&(Y=i.RG16I),G===i.INT&&(Y=i.RG32I)),E===i.RGB_INTEGER&&(G===i.UNSIGNED_BYTE&&(Y=i.RGB8UI),G===i.UNSIGNED_SHORT&&(Y=i.RGB16UI),G===i.UNSIGNED_INT&&(Y=i.RGB32UI),G===i.BYTE&&(Y=i.RGB8I),G===i.SHORT&&(Y=i.RGB16I),G===i.INT&&(Y=i.RGB32I)),E===i.RGBA_INTEGER&&(G===i.UNSIGNED_BYTE&&(Y=i.RGBA8UI),G===i.UNSIGNED_SHORT&&(Y=i.RGBA16UI),G===i.UNSIGNED_INT&&(Y=i.RGBA32UI),G===i.BYTE&&(Y=i.RGBA8I),G===i.SHORT&&(Y=i.RGBA16I),G===i.INT&&(Y=i.RGBA32I)),E===i.RGB&&(G===i.UNSIGNED_SHORT&&dt&&(Y=dt.RGB16_EXT),G===i.SHORT&&dt&&(Y=dt.RGB16_SNORM_EXT),G===i.UNSIGNED_INT_5_9_9_9_REV&&(Y=i.RGB9_E5),G===i.UNSIGNED_INT_10F_11F_11F_REV&&(Y=i.R11F_G11F_B10F)),E===i.RGBA){let Z=ot?uo:Jt.getTransfer(j);G===i.FLOAT&&(Y=i.RGBA32F),G===i.HALF_FLOAT&&(Y=i.RGBA16F),G===i.UNSIGNED_BYTE&&(Y=Z===oe?i.SRGB8_ALPHA8:i.RGBA8),G===i.UNSIGNED_SHORT&&dt&&(Y=dt.RGBA16_EXT),G===i.SHORT&&dt&&(Y=dt.RGBA16_SNORM_EXT),G===i.UNSIGNED_SHORT_4_4_4_4&&(Y=i.RGBA4),G===i.UNSIGNED_SHORT_5_5_5_1&&(Y=i.RGB5_A1)}return(Y===i.R16F||Y===i.R32F||Y===i.RG16F||Y===i.RG32F||Y===i.RGBA16F||Y===i.RGBA32F)&&t.get("EXT_color_buffer_float"),Y}function x(I,E){let G;return I?E===null||E===ai||E===Us?G=i.DEPTH24_STENCIL8:E===Rn?G=i.DEPTH32F_STENCIL8:E===Ar&&(G=i.DEPTH24_STENCIL8,It("DepthTexture: 16 bit depth attachment is not supported with stencil. Using 24-bit attachment.")):E===null||E===ai||E===Us?G=i.DEPTH_COMPONENT24:E===Rn?G=i.DEPTH_COMPONENT32F:E===Ar&&(G=i.DEPTH_COMPONENT16),G}function w(I,E){return b(I)===!0||I.isFramebufferTexture&&I.minFilter!==ye&&I.minFilter!==yn?Math.log2(Math.max(E.width,E.height))+1:I.mipmaps.length>0?I.mipmaps.length:I.isCompressedTexture&&Array.isArray(I.image)?E.mipmaps.length:1}function D(I){let E=new WeakRef(I);n.get(I).__ref=E,p.add(E),_.register(I,E,E)}function R(I){let E=n.get(I).__ref;E!==void 0&&(p.delete(E),_.unregister(E))}function N(I){U(I.target)}function P(I){L(I.target)}function U(I){I.removeEventListener("dispose",N),R(I),z(I),I.isVideoTexture&&h.delete(I),I.isHTMLTexture&&u.delete(I)}function L(I){I.removeEventListener("dispose",P),R(I),et(I)}function k(){for(let I of p){let E=I.deref();E!==void 0&&(E.isRenderTarget===!0?L(E):U(E))}p.clear(),u.clear()}function z(I){let E=n.get(I);if(E.__webglInit===void 0)return;let G=I.source,it=f.get(G);if(it){let j=it[E.__cacheKey];j.usedTimes--,j.usedTimes===0&&W(I),Object.keys(it).length===0&&f.delete(G)}n.remove(I)}function W(I){let E=n.get(I);i.deleteTexture(E.__webglTexture);let G=I.source,it=f.get(G);delete it[E.__cacheKey],o.memory.textures--}function et(I){let E=n.get(I);E.__depthDisposeCallback&&E.__depthDisposeCallback();let G=I.depthTexture;if(G&&G.renderTarget===I&&U(G),I.isWebGLCubeRenderTarget)for(let j=0;j<6;j++){if(Array.isArray(E.__webglFramebuffer[j]))for(let ot=0;ot<E.__webglFramebuffer[j].length;ot++)i.deleteFramebuffer(E.__webglFramebuffer[j][ot]);else i.deleteFramebuffer(E.__webglFramebuffer[j]);E.__webglDepthbuffer&&i.deleteRenderbuffer(E.__webglDepthbuffer[j])}else{if(Array.isArray(E.__webglFramebuffer))for(let j=0;j<E.__webglFramebuffer.length;j++)i.deleteFramebuffer(E.__webglFramebuffer[j]);else i.deleteFramebuffer(E.__webglFramebuffer);if(E.__webglDepthbuffer&&i.deleteRenderbuffer(E.__webglDepthbuffer),E.__webglMultisampledFramebuffer&&i.deleteFramebuffer(E.__webglMultisampledFramebuffer),E.__webglColorRenderbuffer)for(let j=0;j<E.__webglColorRenderbuffer.length;j++)E.__webglColorRenderbuffer[j]&&i.deleteRenderbuffer(E.__webglColorRenderbuffer[j]);E.__webglDepthRenderbuffer&&i.deleteRenderbuffer(E.__webglDepthRenderbuffer)}let it=I.textures;for(let j=0,ot=it.length;j<ot;j++){let dt=n.get(it[j]);dt.__webglTexture&&(i.deleteTexture(dt.__webglTexture),o.memory.textures--),n.remove(it[j])}n.remove(I)}let X=0;function Q(){X=0}function tt(){return X}function vt(I){X=I}function Ft(){let I=X;return I>=s.maxTextures&&It("WebGLTextures: Trying to use "+(I+1)+" texture units while this GPU supports only "+s.maxTextures),X+=1,I}function J(I){let E=[];return E.push(I.wrapS),E.push(I.wrapT),E.push(I.wrapR||0),E.push(I.magFilter),E.push(I.minFilter),E.push(I.anisotropy),E.push(I.internalFormat),E.push(I.format),E.push(I.type),E.push(I.generateMipmaps),E.push(I.mipmapsAutoUpdate),E.push(I.premultiplyAlpha),E.push(I.flipY),E.push(I.unpackAlignment),E.push(I.colorSpace),E.join()}function ut(I,E){let G=n.get(I);if(I.isVideoTexture&&ke(I),I.isRenderTargetTexture===!1&&I.isExternalTexture!==!0&&I.version>0&&G.__version!==I.version){let it=I.image;if(it===null)It("WebGLRenderer: Texture marked for update but no image data found.");else if(it.complete===!1)It("WebGLRenderer: Texture marked for update but image is incomplete");else{Be(G,I,E);return}}else I.isExternalTexture&&(G.__webglTexture=I.sourceTexture?I.sourceTexture:null);e.bindTexture(i.TEXTURE_2D,G.__webglTexture,i.TEXTURE0+E)}function xt(I,E){let G=n.get(I);if(I.isRenderTargetTexture===!1&&I.version>0&&G.__version!==I.version){Be(G,I,E);return}else I.isExternalTexture&&(G.__webglTexture=I.sourceTexture?I.sourceTexture:null);e.bindTexture(i.TEXTURE_2D_ARRAY,G.__webglTexture,i.TEXTURE0+E)}function Ct(I,E){let G=n.get(I);if(I.isRenderTargetTexture===!1&&I.version>0&&G.__version!==I.version){Be(G,I,E);return}e.bindTexture(i.TEXTURE_3D,G.__webglTexture,i.TEXTURE0+E)}function mt(I,E){let G=n.get(I);if(I.version>0&&G.__version!==I.version){wn(G,I,E);return}e.bindTexture(i.TEXTURE_CUBE_MAP,G.__webglTexture,i.TEXTURE0+E)}let Bt={[pl]:i.REPEAT,[pi]:i.CLAMP_TO_EDGE,[ml]:i.MIRRORED_REPEAT},Ce={[ye]:i.NEAREST,[nm]:i.NEAREST_MIPMAP_NEAREST,[Lo]:i.NEAREST_MIPMAP_LINEAR,[yn]:i.LINEAR,[Gl]:i.LINEAR_MIPMAP_NEAREST,[Vi]:i.LINEAR_MIPMAP_LINEAR},Lt={[om]:i.NEVER,[zu]:i.ALWAYS,[am]:i.LESS,[Bu]:i.LEQUAL,[lm]:i.EQUAL,[ku]:i.GEQUAL,[cm]:i.GREATER,[hm]:i.NOTEQUAL};function Qt(I,E){if(E.type===Rn&&t.has("OES_texture_float_linear")===!1&&(E.magFilter===yn||E.magFilter===Gl||E.magFilter===Lo||E.magFilter===Vi||E.minFilter===yn||E.minFilter===Gl||E.minFilter===Lo||E.minFilter===Vi)&&It("WebGLRenderer: Unable to use linear filtering with floating point textures. OES_texture_float_linear not supported on this device."),i.texParameteri(I,i.TEXTURE_WRAP_S,Bt[E.wrapS]),i.texParameteri(I,i.TEXTURE_WRAP_T,Bt[E.wrapT]),(I===i.TEXTURE_3D||I===i.TEXTURE_2D_ARRAY)&&i.texParameteri(I,i.TEXTURE_WRAP_R,Bt[E.wrapR]),i.texParameteri(I,i.TEXTURE_MAG_FILTER,Ce[E.magFilter]),i.texParameteri(I,i.TEXTURE_MIN_FILTER,Ce[E.minFilter]),E.compareFunction&&(i.texParameteri(I,i.TEXTURE_COMPARE_MODE,i.COMPARE_REF_TO_TEXTURE),i.texParameteri(I,i.TEXTURE_COMPARE_FUNC,Lt[E.compareFunction])),t.has("EXT_texture_filter_anisotropic")===!0){if(E.magFilter===ye||E.minFilter!==Lo&&E.minFilter!==Vi||E.type===Rn&&t.has("OES_texture_float_linear")===!1)return;if(E.anisotropy>1||n.get(E).__currentAnisotropy){let G=t.get("EXT_texture_filter_anisotropic");i.texParameterf(I,G.TEXTURE_MAX_ANISOTROPY_EXT,Math.min(E.anisotropy,s.getMaxAnisotropy())),n.get(E).__currentAnisotropy=E.anisotropy}}}function he(I,E){let G=!1;I.__webglInit===void 0&&(I.__webglInit=!0,E.addEventListener("dispose",N),D(E));let it=E.source,j=f.get(it);j===void 0&&(j={},f.set(it,j));let ot=J(E);if(ot!==I.__cacheKey){j[ot]===void 0&&(j[ot]={texture:i.createTexture(),usedTimes:0},o.memory.textures++,G=!0),j[ot].usedTimes++;let dt=j[I.__cacheKey];dt!==void 0&&(j[I.__cacheKey].usedTimes--,dt.usedTimes===0&&W(E)),I.__cacheKey=ot,I.__webglTexture=j[ot].texture}return G}function qt(I,E,G){return Math.floor(Math.floor(I/G)/E)}function Je(I,E,G,it){let ot=I.updateRanges;if(ot.length===0)e.texSubImage2D(i.TEXTURE_2D,0,0,0,E.width,E.height,G,it,E.data);else{ot.sort((F,K)=>F.start-K.start);let dt=0;for(let F=1;F<ot.length;F++){let K=ot[dt],q=ot[F],ct=K.start+K.count,rt=qt(q.start,E.width,4),at=qt(K.start,E.width,4);q.start<=ct+1&&rt===at&&qt(q.start+q.count-1,E.width,4)===rt?K.count=Math.max(K.count,q.start+q.count-K.start):(++dt,ot[dt]=q)}ot.length=dt+1;let Y=e.getParameter(i.UNPACK_ROW_LENGTH),Z=e.getParameter(i.UNPACK_SKIP_PIXELS),lt=e.getParameter(i.UNPACK_SKIP_ROWS);e.pixelStorei(i.UNPACK_ROW_LENGTH,E.width);for(let F=0,K=ot.length;F<K;F++){let q=ot[F],ct=Math.floor(q.start/4),rt=Math.ceil(q.count/4),at=ct%E.width,Et=Math.floor(ct/E.width),Wt=rt,st=1;e.pixelStorei(i.UNPACK_SKIP_PIXELS,at),e.pixelStorei(i.UNPACK_SKIP_ROWS,Et),e.texSubImage2D(i.TEXTURE_2D,0,at,Et,Wt,st,G,it,E.data)}I.clearUpdateRanges(),e.pixelStorei(i.UNPACK_ROW_LENGTH,Y),e.pixelStorei(i.UNPACK_SKIP_PIXELS,Z),e.pixelStorei(i.UNPACK_SKIP_ROWS,lt)}}function Be(I,E,G){let it=i.TEXTURE_2D;(E.isDataArrayTexture||E.isCompressedArrayTexture)&&(it=i.TEXTURE_2D_ARRAY),E.isData3DTexture&&(it=i.TEXTURE_3D);let j=he(I,E),ot=E.source;e.bindTexture(it,I.__webglTexture,i.TEXTURE0+G);let dt=n.get(ot);if(ot.version!==dt.__version||j===!0){if(e.activeTexture(i.TEXTURE0+G),(typeof ImageBitmap<"u"&&E.image instanceof ImageBitmap)===!1){let st=Jt.getPrimaries(Jt.workingColorSpace),Rt=E.colorSpace===Hi?null:Jt.getPrimaries(E.colorSpace),Gt=E.colorSpace===Hi||st===Rt?i.NONE:i.BROWSER_DEFAULT_WEBGL;e.pixelStorei(i.UNPACK_FLIP_Y_WEBGL,E.flipY),e.pixelStorei(i.UNPACK_PREMULTIPLY_ALPHA_WEBGL,E.premultiplyAlpha),e.pixelStorei(i.UNPACK_COLORSPACE_CONVERSION_WEBGL,Gt)}e.pixelStorei(i.UNPACK_ALIGNMENT,E.unpackAlignment);let Z=y(E.image,!1,s.maxTextureSize);Z=Dt(E,Z);let lt=r.convert(E.format,E.colorSpace),F=r.convert(E.type),K=A(E.internalFormat,lt,F,E.normalized,E.colorSpace,E.isVideoTexture);Qt(it,E);let q,ct=E.mipmaps,rt=E.isVideoTexture!==!0,at=dt.__version===void 0||j===!0,Et=ot.dataReady,Wt=w(E,Z);if(E.isDepthTexture)K=x(E.format===Gi,E.type),at&&(rt?e.texStorage2D(i.TEXTURE_2D,1,K,Z.width,Z.height):e.texImage2D(i.TEXTURE_2D,0,K,Z.width,Z.height,0,lt,F,null));else if(E.isDataTexture)if(ct.length>0){rt&&at&&e.texStorage2D(i.TEXTURE_2D,Wt,K,ct[0].width,ct[0].height);for(let st=0,Rt=ct.length;st<Rt;st++)q=ct[st],rt?Et&&e.texSubImage2D(i.TEXTURE_2D,st,0,0,q.width,q.height,lt,F,q.data):e.texImage2D(i.TEXTURE_2D,st,K,q.width,q.height,0,lt,F,q.data);E.generateMipmaps=!1}else rt?(at&&e.texStorage2D(i.TEXTURE_2D,Wt,K,Z.width,Z.height),Et&&Je(E,Z,lt,F)):e.texImage2D(i.TEXTURE_2D,0,K,Z.width,Z.height,0,lt,F,Z.data);else if(E.isCompressedTexture)if(E.isCompressedArrayTexture){rt&&at&&e.texStorage3D(i.TEXTURE_2D_ARRAY,Wt,K,ct[0].width,ct[0].height,Z.depth);for(let st=0,Rt=ct.length;st<Rt;st++)if(q=ct[st],E.format!==sn)if(lt!==null)if(rt){if(Et)if(E.layerUpdates.size>0){let Gt=Ju(q.width,q.height,E.format,E.type);for(let gt of E.layerUpdates){let le=q.data.subarray(gt*Gt/q.data.BYTES_PER_ELEMENT,(gt+1)*Gt/q.data.BYTES_PER_ELEMENT);e.compressedTexSubImage3D(i.TEXTURE_2D_ARRAY,st,0,0,gt,q.width,q.height,1,lt,le)}}else e.compressedTexSubImage3D(i.TEXTURE_2D_ARRAY,st,0,0,0,q.width,q.height,Z.depth,lt,q.data)}else e.compressedTexImage3D(i.TEXTURE_2D_ARRAY,st,K,q.width,q.height,Z.depth,0,q.data,0,0);else It("WebGLRenderer: Attempt to load unsupported compressed texture format in .uploadTexture()");else rt?Et&&e.texSubImage3D(i.TEXTURE_2D_ARRAY,st,0,0,0,q.width,q.height,Z.depth,lt,F,q.data):e.texImage3D(i.TEXTURE_2D_ARRAY,st,K,q.width,q.height,Z.depth,0,lt,F,q.data);E.layerUpdates.size>0&&E.clearLayerUpdates()}else{rt&&at&&e.texStorage2D(i.TEXTURE_2D,Wt,K,ct[0].width,ct[0].height);for(let st=0,Rt=ct.length;st<Rt;st++)q=ct[st],E.format!==sn?lt!==null?rt?Et&&e.compressedTexSubImage2D(i.TEXTURE_2D,st,0,0,q.width,q.height,lt,q.data):e.compressedTexImage2D(i.TEXTURE_2D,st,K,q.width,q.height,0,q.data):It("WebGLRenderer: Attempt to load unsupported compressed texture format in .uploadTexture()"):rt?Et&&e.texSubImage2D(i.TEXTURE_2D,st,0,0,q.width,q.height,lt,F,q.data):e.texImage2D(i.TEXTURE_2D,st,K,q.width,q.height,0,lt,F,q.data)}else if(E.isDataArrayTexture)if(rt){if(at&&e.texStorage3D(i.TEXTURE_2D_ARRAY,Wt,K,Z.width,Z.height,Z.depth),Et)if(E.layerUpdates.size>0){let st=Ju(Z.width,Z.height,E.format,E.type);for(let Rt of E.layerUpdates){let Gt=Z.data.subarray(Rt*st/Z.data.BYTES_PER_ELEMENT,(Rt+1)*st/Z.data.BYTES_PER_ELEMENT);e.texSubImage3D(i.TEXTURE_2D_ARRAY,0,0,0,Rt,Z.width,Z.height,1,lt,F,Gt)}E.clearLayerUpdates()}else e.texSubImage3D(i.TEXTURE_2D_ARRAY,0,0,0,0,Z.width,Z.height,Z.depth,lt,F,Z.data)}else e.texImage3D(i.TEXTURE_2D_ARRAY,0,K,Z.width,Z.height,Z.depth,0,lt,F,Z.data);else if(E.isData3DTexture)rt?(at&&e.texStorage3D(i.TEXTURE_3D,Wt,K,Z.width,Z.height,Z.depth),Et&&e.texSubImage3D(i.TEXTURE_3D,0,0,0,0,Z.width,Z.height,Z.depth,lt,F,Z.data)):e.texImage3D(i.TEXTURE_3D,0,K,Z.width,Z.height,Z.depth,0,lt,F,Z.data);else if(E.isFramebufferTexture){if(at)if(rt)e.texStorage2D(i.TEXTURE_2D,Wt,K,Z.width,Z.height);else{let st=Z.width,Rt=Z.height;for(let Gt=0;Gt<Wt;Gt++)e.texImage2D(i.TEXTURE_2D,Gt,K,st,Rt,0,lt,F,null),st>>=1,Rt>>=1}}else if(E.isHTMLTexture){if("texElementImage2D"in i){let st=i.canvas;if(st.hasAttribute("layoutsubtree")||st.setAttribute("layoutsubtree","true"),Z.parentNode!==st){st.appendChild(Z),u.add(E),st.onpaint=Rt=>{let Gt=Rt.changedElements;for(let gt of u)Gt.includes(gt.image)&&(gt.needsUpdate=!0)},st.requestPaint();return}if(i.texElementImage2D.length===3)i.texElementImage2D(i.TEXTURE_2D,i.RGBA8,Z);else{let Gt=i.RGBA,gt=i.RGBA,le=i.UNSIGNED_BYTE;i.texElementImage2D(i.TEXTURE_2D,0,Gt,gt,le,Z)}i.texParameteri(i.TEXTURE_2D,i.TEXTURE_MIN_FILTER,i.LINEAR),i.texParameteri(i.TEXTURE_2D,i.TEXTURE_WRAP_S,i.CLAMP_TO_EDGE),i.texParameteri(i.TEXTURE_2D,i.TEXTURE_WRAP_T,i.CLAMP_TO_EDGE)}}else if(ct.length>0){if(rt&&at){let st=kt(ct[0]);e.texStorage2D(i.TEXTURE_2D,Wt,K,st.width,st.height)}for(let st=0,Rt=ct.length;st<Rt;st++)q=ct[st],rt?Et&&e.texSubImage2D(i.TEXTURE_2D,st,0,0,lt,F,q):e.texImage2D(i.TEXTURE_2D,st,K,lt,F,q);E.generateMipmaps=!1}else if(rt){if(at){let st=kt(Z);e.texStorage2D(i.TEXTURE_2D,Wt,K,st.width,st.height)}Et&&e.texSubImage2D(i.TEXTURE_2D,0,0,0,lt,F,Z)}else e.texImage2D(i.TEXTURE_2D,0,K,lt,F,Z);b(E)&&E.mipmapsAutoUpdate===!0&&v(it),dt.__version=ot.version,E.onUpdate&&E.onUpdate(E)}I.__version=E.version}function wn(I,E,G){if(E.image.length!==6)return;let it=he(I,E),j=E.source;e.bindTexture(i.TEXTURE_CUBE_MAP,I.__webglTexture,i.TEXTURE0+G);let ot=n.get(j);if(j.version!==ot.__version||it===!0){e.activeTexture(i.TEXTURE0+G);let dt=Jt.getPrimaries(Jt.workingColorSpace),Y=E.colorSpace===Hi?null:Jt.getPrimaries(E.colorSpace),Z=E.colorSpace===Hi||dt===Y?i.NONE:i.BROWSER_DEFAULT_WEBGL;e.pixelStorei(i.UNPACK_FLIP_Y_WEBGL,E.flipY),e.pixelStorei(i.UNPACK_PREMULTIPLY_ALPHA_WEBGL,E.premultiplyAlpha),e.pixelStorei(i.UNPACK_ALIGNMENT,E.unpackAlignment),e.pixelStorei(i.UNPACK_COLORSPACE_CONVERSION_WEBGL,Z);let lt=E.isCompressedTexture||E.image[0].isCompressedTexture,F=E.image[0]&&E.image[0].isDataTexture,K=[];for(let gt=0;gt<6;gt++)!lt&&!F?K[gt]=y(E.image[gt],!0,s.maxCubemapSize):K[gt]=F?E.image[gt].image:E.image[gt],K[gt]=Dt(E,K[gt]);let q=K[0],ct=r.convert(E.format,E.colorSpace),rt=r.convert(E.type),at=A(E.internalFormat,ct,rt,E.normalized,E.colorSpace),Et=E.isVideoTexture!==!0,Wt=ot.__version===void 0||it===!0,st=j.dataReady,Rt=w(E,q);Qt(i.TEXTURE_CUBE_MAP,E);let Gt;if(E.isDepthTexture){if(at=x(E.format===Gi,E.type),Wt)if(Et)e.texStorage2D(i.TEXTURE_CUBE_MAP,1,at,q.width,q.height);else for(let gt=0;gt<6;gt++)e.texImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+gt,0,at,q.width,q.height,0,ct,rt,null)}else if(lt){Et&&Wt&&e.texStorage2D(i.TEXTURE_CUBE_MAP,Rt,at,q.width,q.height);for(let gt=0;gt<6;gt++){Gt=K[gt].mipmaps;for(let le=0;le<Gt.length;le++){let $e=Gt[le];E.format!==sn?ct!==null?Et?st&&e.compressedTexSubImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+gt,le,0,0,$e.width,$e.height,ct,$e.data):e.compressedTexImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+gt,le,at,$e.width,$e.height,0,$e.data):It("WebGLRenderer: Attempt to load unsupported compressed texture format in .setTextureCube()"):Et?st&&e.texSubImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+gt,le,0,0,$e.width,$e.height,ct,rt,$e.data):e.texImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+gt,le,at,$e.width,$e.height,0,ct,rt,$e.data)}}}else{if(Gt=E.mipmaps,Et&&Wt){Gt.length>0&&Rt++;let gt=kt(K[0]);e.texStorage2D(i.TEXTURE_CUBE_MAP,Rt,at,gt.width,gt.height)}for(let gt=0;gt<6;gt++)if(F){Et?st&&e.texSubImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+gt,0,0,0,K[gt].width,K[gt].height,ct,rt,K[gt].data):e.texImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+gt,0,at,K[gt].width,K[gt].height,0,ct,rt,K[gt].data);for(let le=0;le<Gt.length;le++){let qi=Gt[le].image[gt].image;Et?st&&e.texSubImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+gt,le+1,0,0,qi.width,qi.height,ct,rt,qi.data):e.texImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+gt,le+1,at,qi.width,qi.height,0,ct,rt,qi.data)}}else{Et?st&&e.texSubImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+gt,0,0,0,ct,rt,K[gt]):e.texImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+gt,0,at,ct,rt,K[gt]);for(let le=0;le<Gt.length;le++){let $e=Gt[le];Et?st&&e.texSubImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+gt,le+1,0,0,ct,rt,$e.image[gt]):e.texImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+gt,le+1,at,ct,rt,$e.image[gt])}}}b(E)&&E.mipmapsAutoUpdate===!0&&v(i.TEXTURE_CUBE_MAP),ot.__version=j.version,E.onUpdate&&E.onUpdate(E)}I.__version=E.version}function we(I,E,G,it,j,ot){let dt=r.convert(G.format,G.colorSpace),Y=r.convert(G.type),Z=A(G.internalFormat,dt,Y,G.normalized,G.colorSpace),lt=n.get(E),F=n.get(G);if(F.__renderTarget=E,!lt.__hasExternalTextures){let K=Math.max(1,E.width>>ot),q=Math.max(1,E.height>>ot);j===i.TEXTURE_3D||j===i.TEXTURE_2D_ARRAY?e.texImage3D(j,ot,Z,K,q,E.depth,0,dt,Y,null):e.texImage2D(j,ot,Z,K,q,0,dt,Y,null)}e.bindFramebuffer(i.FRAMEBUFFER,I),pt(E)?a.framebufferTexture2DMultisampleEXT(i.FRAMEBUFFER,it,j,F.__webglTexture,0,be(E)):(j===i.TEXTURE_2D||j>=i.TEXTURE_CUBE_MAP_POSITIVE_X&&j<=i.TEXTURE_CUBE_MAP_NEGATIVE_Z)&&i.framebufferTexture2D(i.FRAMEBUFFER,it,j,F.__webglTexture,ot),e.bindFramebuffer(i.FRAMEBUFFER,null)}function di(I,E,G){if(i.bindRenderbuffer(i.RENDERBUFFER,I),E.depthBuffer){let it=E.depthTexture,j=it&&it.isDepthTexture?it.type:null,ot=x(E.stencilBuffer,j),dt=E.stencilBuffer?i.DEPTH_STENCIL_ATTACHMENT:i.DEPTH_ATTACHMENT;pt(E)?a.renderbufferStorageMultisampleEXT(i.RENDERBUFFER,be(E),ot,E.width,E.height):G?i.renderbufferStorageMultisample(i.RENDERBUFFER,be(E),ot,E.width,E.height):i.renderbufferStorage(i.RENDERBUFFER,ot,E.width,E.height),i.framebufferRenderbuffer(i.FRAMEBUFFER,dt,i.RENDERBUFFER,I)}else{let it=E.textures;for(let j=0;j<it.length;j++){let ot=it[j],dt=r.convert(ot.format,ot.colorSpace),Y=r.convert(ot.type),Z=A(ot.internalFormat,dt,Y,ot.normalized,ot.colorSpace);pt(E)?a.renderbufferStorageMultisampleEXT(i.RENDERBUFFER,be(E),Z,E.width,E.height):G?i.renderbufferStorageMultisample(i.RENDERBUFFER,be(E),Z,E.width,E.height):i.renderbufferStorage(i.RENDERBUFFER,Z,E.width,E.height)}}i.bindRenderbuffer(i.RENDERBUFFER,null)}function We(I,E,G){let it=E.isWebGLCubeRenderTarget===!0;if(e.bindFramebuffer(i.FRAMEBUFFER,I),!(E.depthTexture&&E.depthTexture.isDepthTexture))throw new Error("THREE.WebGLTextures: renderTarget.depthTexture must be an instance of THREE.DepthTexture.");let j=n.get(E.depthTexture);j.__renderTarget=E;let ot=it?E.depthTexture.image[0]:E.depthTexture.image;(!j.__webglTexture||ot.width!==E.width||ot.height!==E.height)&&(ot.width=E.width,ot.height=E.height,E.depthTexture.needsUpdate=!0),it?mt(E.depthTexture,0):ut(E.depthTexture,0);let dt=j.__webglTexture,Y=be(E),Z=it?i.TEXTURE_CUBE_MAP_POSITIVE_X+G:i.TEXTURE_2D,lt=E.depthTexture.format===Gi?i.DEPTH_STENCIL_ATTACHMENT:i.DEPTH_ATTACHMENT;if(E.depthTexture.format===Li)pt(E)?a.framebufferTexture2DMultisampleEXT(i.FRAMEBUFFER,lt,Z,dt,0,Y):i.framebufferTexture2D(i.FRAMEBUFFER,lt,Z,dt,0);else if(E.depthTexture.format===Gi)pt(E)?a.framebufferTexture2DMultisampleEXT(i.FRAMEBUFFER,lt,Z,dt,0,Y):i.framebufferTexture2D(i.FRAMEBUFFER,lt,Z,dt,0);else throw new Error("THREE.WebGLTextures: Unknown depthTexture format.")}function Hn(I){let E=n.get(I),G=I.isWebGLCubeRenderTarget===!0;if(E.__boundDepthTexture!==I.depthTexture){let it=I.depthTexture;if(E.__depthDisposeCallback&&E.__depthDisposeCallback(),it){let j=()=>{delete E.__boundDepthTexture,delete E.__depthDisposeCallback,it.removeEventListener("dispose",j)};it.addEventListener("dispose",j),E.__depthDisposeCallback=j}E.__boundDepthTexture=it}if(I.depthTexture&&!E.__autoAllocateDepthBuffer)if(G)for(let it=0;it<6;it++)We(E.__webglFramebuffer[it],I,it);else I.texture.mipmaps.length>0?We(E.__webglFramebuffer[0],I,0):We(E.__webglFramebuffer,I,0);else if(G){E.__webglDepthbuffer=[];for(let it=0;it<6;it++)if(e.bindFramebuffer(i.FRAMEBUFFER,E.__webglFramebuffer[it]),E.__webglDepthbuffer[it]===void 0)E.__webglDepthbuffer[it]=i.createRenderbuffer(),di(E.__webglDepthbuffer[it],I,!1);else{let j=I.stencilBuffer?i.DEPTH_STENCIL_ATTACHMENT:i.DEPTH_ATTACHMENT,ot=E.__webglDepthbuffer[it];i.bindRenderbuffer(i.RENDERBUFFER,ot),i.framebufferRenderbuffer(i.FRAMEBUFFER,j,i.RENDERBUFFER,ot)}}else if(I.texture.mipmaps.length>0?e.bindFramebuffer(i.FRAMEBUFFER,E.__webglFramebuffer[0]):e.bindFramebuffer(i.FRAMEBUFFER,E.__webglFramebuffer),E.__webglDepthbuffer===void 0)E.__webglDepthbuffer=i.createRenderbuffer(),di(E.__webglDepthbuffer,I,!1);else{let j=I.stencilBuffer?i.DEPTH_STENCIL_ATTACHMENT:i.DEPTH_ATTACHMENT,ot=E.__webglDepthbuffer;i.bindRenderbuffer(i.RENDERBUFFER,ot),i.framebufferRenderbuffer(i.FRAMEBUFFER,j,i.RENDERBUFFER,ot)}e.bindFramebuffer(i.FRAMEBUFFER,null)}function Wn(I,E,G){let it=n.get(I);E!==void 0&&we(it.__webglFramebuffer,I,I.texture,i.COLOR_ATTACHMENT0,i.TEXTURE_2D,0),G!==void 0&&Hn(I)}function $n(I){let E=I.texture,G=n.get(I),it=n.get(E);I.addEventListener("dispose",P),D(I);let j=I.textures,ot=I.isWebGLCubeRenderTarget===!0,dt=j.length>1;if(dt||(it.__webglTexture===void 0&&(it.__webglTexture=i.createTexture()),it.__version=E.version,o.memory.textures++),ot){G.__webglFramebuffer=[];for(let Y=0;Y<6;Y++)if(E.mipmaps.length>0){G.__webglFramebuffer[Y]=[];for(let Z=0;Z<E.mipmaps.length;Z++)G.__webglFramebuffer[Y][Z]=i.createFramebuffer()}else G.__webglFramebuffer[Y]=i.createFramebuffer()}else{if(E.mipmaps.length>0){G.__webglFramebuffer=[];for(let Y=0;Y<E.mipmaps.length;Y++)G.__webglFramebuffer[Y]=i.createFramebuffer()}else G.__webglFramebuffer=i.createFramebuffer();if(dt)for(let Y=0,Z=j.length;Y<Z;Y++){let lt=n.get(j[Y]);lt.__webglTexture===void 0&&(lt.__webglTexture=i.createTexture(),o.memory.textures++)}if(I.samples>0&&pt(I)===!1){G.__webglMultisampledFramebuffer=i.createFramebuffer(),G.__webglColorRenderbuffer=[],e.bindFramebuffer(i.FRAMEBUFFER,G.__webglMultisampledFramebuffer);for(let Y=0;Y<j.length;Y++){let Z=j[Y];G.__webglColorRenderbuffer[Y]=i.createRenderbuffer(),i.bindRenderbuffer(i.RENDERBUFFER,G.__webglColorRenderbuffer[Y]);let lt=r.convert(Z.format,Z.colorSpace),F=r.convert(Z.type),K=A(Z.internalFormat,lt,F,Z.normalized,Z.colorSpace,I.isXRRenderTarget===!0),q=be(I);i.renderbufferStorageMultisample(i.RENDERBUFFER,q,K,I.width,I.height),i.framebufferRenderbuffer(i.FRAMEBUFFER,i.COLOR_ATTACHMENT0+Y,i.RENDERBUFFER,G.__webglColorRenderbuffer[Y])}i.bindRenderbuffer(i.RENDERBUFFER,null),I.depthBuffer&&(G.__webglDepthRenderbuffer=i.createRenderbuffer(),di(G.__webglDepthRenderbuffer,I,!0)),e.bindFramebuffer(i.FRAMEBUFFER,null)}}if(ot){e.bindTexture(i.TEXTURE_CUBE_MAP,it.__webglTexture),Qt(i.TEXTURE_CUBE_MAP,E);for(let Y=0;Y<6;Y++)if(E.mipmaps.length>0)for(let Z=0;Z<E.mipmaps.length;Z++)we(G.__webglFramebuffer[Y][Z],I,E,i.COLOR_ATTACHMENT0,i.TEXTURE_CUBE_MAP_POSITIVE_X+Y,Z);else we(G.__webglFramebuffer[Y],I,E,i.COLOR_ATTACHMENT0,i.TEXTURE_CUBE_MAP_POSITIVE_X+Y,0);b(E)?v(i.TEXTURE_CUBE_MAP):E.mipmaps.length>0&&i.texParameteri(i.TEXTURE_CUBE_MAP,i.TEXTURE_MAX_LEVEL,E.mipmaps.length-1),e.unbindTexture()}else if(dt){for(let Y=0,Z=j.length;Y<Z;Y++){let lt=j[Y],F=n.get(lt),K=i.TEXTURE_2D;(I.isWebGL3DRenderTarget||I.isWebGLArrayRenderTarget)&&(K=I.isWebGL3DRenderTarget?i.TEXTURE_3D:i.TEXTURE_2D_ARRAY),e.bindTexture(K,F.__webglTexture),Qt(K,lt),we(G.__webglFramebuffer,I,lt,i.COLOR_ATTACHMENT0+Y,K,0),b(lt)&&v(K)}e.unbindTexture()}else{let Y=i.TEXTURE_2D;if((I.isWebGL3DRenderTarget||I.isWebGLArrayRenderTarget)&&(Y=I.isWebGL3DRenderTarget?i.TEXTURE_3D:i.TEXTURE_2D_ARRAY),e.bindTexture(Y,it.__webglTexture),Qt(Y,E),E.mipmaps.length>0)for(let Z=0;Z<E.mipmaps.length;Z++)we(G.__webglFramebuffer[Z],I,E,i.COLOR_ATTACHMENT0,Y,Z);else we(G.__webglFramebuffer,I,E,i.COLOR_ATTACHMENT0,Y,0);b(E)?v(Y):E.mipmaps.length>0&&i.texParameteri(Y,i.TEXTURE_MAX_LEVEL,E.mipmaps.length-1),e.unbindTexture()}I.depthBuffer&&Hn(I)}function B(I){let E=I.textures;for(let G=0,it=E.length;G<it;G++){let j=E[G];if(b(j)&&j.mipmapsAutoUpdate===!0){let ot=M(I),dt=n.get(j).__webglTexture;e.bindTexture(ot,dt),v(ot),e.unbindTexture()}}}let Xn=[];function ve(I){if(I.samples>0){if(pt(I)===!1){let E=I.textures,G=I.width,it=I.height,j=i.COLOR_BUFFER_BIT,ot=I.stencilBuffer?i.DEPTH_STENCIL_ATTACHMENT:i.DEPTH_ATTACHMENT,dt=n.get(I),Y=E.length>1;if(Y)for(let lt=0;lt<E.length;lt++)e.bindFramebuffer(i.FRAMEBUFFER,dt.__webglMultisampledFramebuffer),i.framebufferRenderbuffer(i.FRAMEBUFFER,i.COLOR_ATTACHMENT0+lt,i.RENDERBUFFER,null),e.bindFramebuffer(i.FRAMEBUFFER,dt.__webglFramebuffer),i.framebufferTexture2D(i.DRAW_FRAMEBUFFER,i.COLOR_ATTACHMENT0+lt,i.TEXTURE_2D,null,0);e.bindFramebuffer(i.READ_FRAMEBUFFER,dt.__webglMultisampledFramebuffer),I.texture.mipmaps.length>0?e.bindFramebuffer(i.DRAW_FRAMEBUFFER,dt.__webglFramebuffer[0]):e.bindFramebuffer(i.DRAW_FRAMEBUFFER,dt.__webglFramebuffer);for(let lt=0;lt<E.length;lt++){if(I.resolveDepthBuffer&&(I.depthBuffer&&(j|=i.DEPTH_BUFFER_BIT),I.stencilBuffer&&I.resolveStencilBuffer&&(j|=i.STENCIL_BUFFER_BIT)),Y){i.framebufferRenderbuffer(i.READ_FRAMEBUFFER,i.COLOR_ATTACHMENT0,i.RENDERBUFFER,dt.__webglColorRenderbuffer[lt]);let F=n.get(E[lt]).__webglTexture;i.framebufferTexture2D(i.DRAW_FRAMEBUFFER,i.COLOR_ATTACHMENT0,i.TEXTURE_2D,F,0)}i.blitFramebuffer(0,0,G,it,0,0,G,it,j,i.NEAREST),l===!0&&(Xn.length=0,Xn.push(i.COLOR_ATTACHMENT0+lt),I.depthBuffer&&I.storeMultisampledDepthBuffer===!1&&Xn.push(ot),i.invalidateFramebuffer(i.READ_FRAMEBUFFER,Xn))}if(e.bindFramebuffer(i.READ_FRAMEBUFFER,null),e.bindFramebuffer(i.DRAW_FRAMEBUFFER,null),Y)for(let lt=0;lt<E.length;lt++){e.bindFramebuffer(i.FRAMEBUFFER,dt.__webglMultisampledFramebuffer),i.framebufferRenderbuffer(i.FRAMEBUFFER,i.COLOR_ATTACHMENT0+lt,i.RENDERBUFFER,dt.__webglColorRenderbuffer[lt]);let F=n.get(E[lt]).__webglTexture;e.bindFramebuffer(i.FRAMEBUFFER,dt.__webglFramebuffer),i.framebufferTexture2D(i.DRAW_FRAMEBUFFER,i.COLOR_ATTACHMENT0+lt,i.TEXTURE_2D,F,0)}e.bindFramebuffer(i.DRAW_FRAMEBUFFER,dt.__webglMultisampledFramebuffer)}else if(I.depthBuffer&&I.storeMultisampledDepthBuffer===!1&&l){let E=I.stencilBuffer?i.DEPTH_STENCIL_ATTACHMENT:i.DEPTH_ATTACHMENT;i.invalidateFramebuffer(i.DRAW_FRAMEBUFFER,[E])}}}function be(I){return Math.min(s.maxSamples,I.samples)}function pt(I){let E=n.get(I);return I.samples>0&&t.has("WEBGL_multisampled_render_to_texture")===!0&&E.__useRenderToTexture!==!1}function ke(I){let E=o.render.frame;h.get(I)!==E&&(h.set(I,E),I.update())}function Dt(I,E){let G=I.colorSpace,it=I.format,j=I.type;return I.isCompressedTexture===!0||I.isVideoTexture===!0||G!==ho&&G!==Hi&&(Jt.getTransfer(G)===oe?(it!==sn||j!==Bn)&&It("WebGLTextures: sRGB encoded textures have to use RGBAFormat and UnsignedByteType."):Nt("WebGLTextures: Unsupported texture color space:",G)),E}function kt(I){return typeof HTMLImageElement<"u"&&I instanceof HTMLImageElement?(c.width=I.naturalWidth||I.width,c.height=I.naturalHeight||I.height):typeof VideoFrame<"u"&&I instanceof VideoFrame?(c.width=I.displayWidth,c.height=I.displayHeight):(c.width=I.width,c.height=I.height),c}this.allocateTextureUnit=Ft,this.resetTextureUnits=Q,this.getTextureUnits=tt,this.setTextureUnits=vt,this.setTexture2D=ut,this.setTexture2DArray=xt,this.setTexture3D=Ct,this.setTextureCube=mt,this.rebindTextures=Wn,this.setupRenderTarget=$n,this.updateRenderTargetMipmap=B,this.updateMultisampleRenderTarget=ve,this.setupDepthRenderbuffer=Hn,this.setupFrameBufferTexture=we,this.useMultisampledRTT=pt,this.dispose=k}function vS(i,t){function e(n,s=Hi){let r,o=Jt.getTransfer(s);if(n===Bn)return i.UNSIGNED_BYTE;if(n===Wl)return i.UNSIGNED_SHORT_4_4_4_4;if(n===$l)return i.UNSIGNED_SHORT_5_5_5_1;if(n===Du)return i.UNSIGNED_INT_5_9_9_9_REV;if(n===Nu)return i.UNSIGNED_INT_10F_11F_11F_REV;if(n===Iu)return i.BYTE;if(n===Lu)return i.SHORT;if(n===Ar)return i.UNSIGNED_SHORT;if(n===Hl)return i.INT;if(n===ai)return i.UNSIGNED_INT;if(n===Rn)return i.FLOAT;if(n===li)return i.HALF_FLOAT;if(n===Fu)return i.ALPHA;if(n===Uu)return i.RGB;if(n===sn)return i.RGBA;if(n===Li)return i.DEPTH_COMPONENT;if(n===Gi)return i.DEPTH_STENCIL;if(n===Do)return i.RED;if(n===Xl)return i.RED_INTEGER;if(n===_i)return i.RG;if(n===ql)return i.RG_INTEGER;if(n===Yl)return i.RGBA_INTEGER;if(n===No||n===Fo||n===Uo||n===Oo)if(o===oe)if(r=t.get("WEBGL_compressed_texture_s3tc_srgb"),r!==null){if(n===No)return r.COMPRESSED_SRGB_S3TC_DXT1_EXT;if(n===Fo)return r.COMPRESSED_SRGB_ALPHA_S3TC_DXT1_EXT;if(n===Uo)return r.COMPRESSED_SRGB_ALPHA_S3TC_DXT3_EXT;if(n===Oo)return r.COMPRESSED_SRGB_ALPHA_S3TC_DXT5_EXT}else return null;else if(r=t.get("WEBGL_compressed_texture_s3tc"),r!==null){if(n===No)return r.COMPRESSED_RGB_S3TC_DXT1_EXT;if(n===Fo)return r.COMPRESSED_RGBA_S3TC_DXT1_EXT;if(n===Uo)return r.COMPRESSED_RGBA_S3TC_DXT3_EXT;if(n===Oo)return r.COMPRESSED_RGBA_S3TC_DXT5_EXT}else return null;if(n===Zl||n===Jl||n===Kl||n===jl)if(r=t.get("WEBGL_compressed_texture_pvrtc"),r!==null){if(n===Zl)return r.COMPRESSED_RGB_PVRTC_4BPPV1_IMG;if(n===Jl)return r.COMPRESSED_RGB_PVRTC_2BPPV1_IMG;if(n===Kl)return r.COMPRESSED_RGBA_PVRTC_4BPPV1_IMG;if(n===jl)return r.COMPRESSED_RGBA_PVRTC_2BPPV1_IMG}else return null;if(n===Ql||n===tc||n===ec||n===nc||n===ic||n===Bo||n===sc)if(r=t.get("WEBGL_compressed_texture_etc"),r!==null){if(n===Ql||n===tc)return o===oe?r.COMPRESSED_SRGB8_ETC2:r.COMPRESSED_RGB8_ETC2;if(n===ec)return o===oe?r.COMPRESSED_SRGB8_ALPHA8_ETC2_EAC:r.COMPRESSED_RGBA8_ETC2_EAC;if(n===nc)return r.COMPRESSED_R11_EAC;if(n===ic)return r.COMPRESSED_SIGNED_R11_EAC;if(n===Bo)return r.COMPRESSED_RG11_EAC;if(n===sc)return r.COMPRESSED_SIGNED_RG11_EAC}else return null;if(n===rc||n===oc||n===ac||n===lc||n===cc||n===hc||n===uc||n===dc||n===fc||n===pc||n===mc||n===gc||n===_c||n===yc)if(r=t.get("WEBGL_compressed_texture_astc"),r!==null){if(n===rc)return o===oe?r.COMPRESSED_SRGB8_ALPHA8_ASTC_4x4_KHR:r.COMPRESSED_RGBA_ASTC_4x4_KHR;if(n===oc)return o===oe?r.COMPRESSED_SRGB8_ALPHA8_ASTC_5x4_KHR:r.COMPRESSED_RGBA_ASTC_5x4_KHR;if(n===ac)return o===oe?r.COMPRESSED_SRGB8_ALPHA8_ASTC_5x5_KHR:r.COMPRESSED_RGBA_ASTC_5x5_KHR;if(n===lc)return o===oe?r.COMPRESSED_SRGB8_ALPHA8_ASTC_6x5_KHR:r.COMPRESSED_RGBA_ASTC_6x5_KHR;if(n===cc)return o===oe?r.COMPRESSED_SRGB8_ALPHA8_ASTC_6x6_KHR:r.COMPRESSED_RGBA_ASTC_6x6_KHR;if(n===hc)return o===oe?r.COMPRESSED_SRGB8_ALPHA8_ASTC_8x5_KHR:r.COMPRESSED_RGBA_ASTC_8x5_KHR;if(n===uc)return o===oe?r.COMPRESSED_SRGB8_ALPHA8_ASTC_8x6_KHR:r.COMPRESSED_RGBA_ASTC_8x6_KHR;if(n===dc)return o===oe?r.COMPRESSED_SRGB8_ALPHA8_ASTC_8x8_KHR:r.COMPRESSED_RGBA_ASTC_8x8_KHR;if(n===fc)return o===oe?r.COMPRESSED_SRGB8_ALPHA8_ASTC_10x5_KHR:r.COMPRESSED_RGBA_ASTC_10x5_KHR;if(n===pc)return o===oe?r.COMPRESSED_SRGB8_ALPHA8_ASTC_10x6_KHR:r.COMPRESSED_RGBA_ASTC_10x6_KHR;if(n===mc)return o===oe?r.COMPRESSED_SRGB8_ALPHA8_ASTC_10x8_KHR:r.COMPRESSED_RGBA_ASTC_10x8_KHR;if(n===gc)return o===oe?r.COMPRESSED_SRGB8_ALPHA8_ASTC_10x10_KHR:r.COMPRESSED_RGBA_ASTC_10x10_KHR;if(n===_c)return o===oe?r.COMPRESSED_SRGB8_ALPHA8_ASTC_12x10_KHR:r.COMPRESSED_RGBA_ASTC_12x10_KHR;if(n===yc)return o===oe?r.COMPRESSED_SRGB8_ALPHA8_ASTC_12x12_KHR:r.COMPRESSED_RGBA_ASTC_12x12_KHR}else return null;if(n===xc||n===vc||n===bc)if(r=t.get("EXT_texture_compression_bptc"),r!==null){if(n===xc)return o===oe?r.COMPRESSED_SRGB_ALPHA_BPTC_UNORM_EXT:r.COMPRESSED_RGBA_BPTC_UNORM_EXT;if(n===vc)return r.COMPRESSED_RGB_BPTC_SIGNED_FLOAT_EXT;if(n===bc)return r.COMPRESSED_RGB_BPTC_UNSIGNED_FLOAT_EXT}else return null;if(n===Sc||n===Mc||n===ko||n===wc)if(r=t.get("EXT_texture_compression_rgtc"),r!==null){if(n===Sc)return r.COMPRESSED_RED_RGTC1_EXT;if(n===Mc)return r.COMPRESSED_SIGNED_RED_RGTC1_EXT;if(n===ko)return r.COMPRESSED_RED_GREEN_RGTC2_EXT;if(n===wc)return r.COMPRESSED_SIGNED_RED_GREEN_RGTC2_EXT}else return null;return n===Us?i.UNSIGNED_INT_24_8:i[n]!==void 0?i[n]:null}return{convert:e}}var bS=`
void main() {

	gl_Position = vec4( position, 1.0 );

}`,SS=`
uniform sampler2DArray depthColor;
uniform float depthWidth;
uniform float depthHeight;

void main() {

	vec2 coord = vec2( gl_FragCoord.x / depthWidth, gl_FragCoord.y / depthHeight );

	if ( coord.x >= 1.0 ) {

		gl_FragDepth = texture( depthColor, vec3( coord.x - 1.0, coord.y, 1 ) ).r;

	} else {

		gl_FragDepth = texture( depthColor, vec3( coord.x, coord.y, 0 ) ).r;

	}

}`,rd=class{constructor(){this.texture=null,this.mesh=null,this.depthNear=0,this.depthFar=0}init(t,e){if(this.texture===null){let n=new wo(t.texture);(t.depthNear!==e.depthNear||t.depthFar!==e.depthFar)&&(this.depthNear=t.depthNear,this.depthFar=t.depthFar),this.texture=n}}getMesh(t){if(this.texture!==null&&this.mesh===null){let e=t.cameras[0].viewport,n=new Ie({vertexShader:bS,fragmentShader:SS,uniforms:{depthColor:{value:this.texture},depthWidth:{value:e.z},depthHeight:{value:e.w}}});this.mesh=new Ee(new Eo(20,20),n)}return this.mesh}reset(){this.texture=null,this.mesh=null}getDepthTexture(){return this.texture}},od=class extends si{constructor(t,e){super();let n=this,s=null,r=1,o=null,a="local-floor",l=1,c=null,h=null,u=null,d=null,f=null,p=null,_=typeof XRWebGLBinding<"u",m=new rd,g={},y=e.getContextAttributes(),b=null,v=null,M=[],A=[],x=new St,w=null,D=null,R=new _n;R.viewport=new de;let N=new _n;N.viewport=new de;let P=[R,N],U=new kl,L=null,k=null;this.cameraAutoUpdate=!0,this.enabled=!1,this.isPresenting=!1,this.getController=function(J){let ut=M[J];return ut===void 0&&(ut=new xr,M[J]=ut),ut.getTargetRaySpace()},this.getControllerGrip=function(J){let ut=M[J];return ut===void 0&&(ut=new xr,M[J]=ut),ut.getGripSpace()},this.getHand=function(J){let ut=M[J];return ut===void 0&&(ut=new xr,M[J]=ut),ut.getHandSpace()};function z(J){let ut=A.indexOf(J.inputSource);if(ut===-1)return;let xt=M[ut];xt!==void 0&&(xt.update(J.inputSource,J.frame,c||o),xt.dispatchEvent({type:J.type,data:J.inputSource}))}function W(){s.removeEventListener("select",z),s.removeEventListener("selectstart",z),s.removeEventListener("selectend",z),s.removeEventListener("squeeze",z),s.removeEventListener("squeezestart",z),s.removeEventListener("squeezeend",z),s.removeEventListener("end",W),s.removeEventListener("inputsourceschange",et);for(let J=0;J<M.length;J++){let ut=A[J];ut!==null&&(A[J]=null,M[J].disconnect(ut))}L=null,k=null,m.reset();for(let J in g)delete g[J];if(t.setRenderTarget(b),f=null,d=null,u=null,s=null,v=null,Ft.stop(),n.isPresenting=!1,t.setPixelRatio(w),t.setSize(x.width,x.height,!1),D!==null){let J=D.camera;J.fov=D.fov,J.zoom=D.zoom,J.updateProjectionMatrix(),D=null}n.dispatchEvent({type:"sessionend"})}this.setFramebufferScaleFactor=function(J){r=J,n.isPresenting===!0&&It("WebXRManager: Cannot change framebuffer scale while presenting.")},this.setReferenceSpaceType=function(J){a=J,n.isPresenting===!0&&It("WebXRManager: Cannot change reference space type while presenting.")},this.getReferenceSpace=function(){return c||o},this.setReferenceSpace=function(J){c=J},this.getBaseLayer=function(){return d!==null?d:f},this.getBinding=function(){return u===null&&_&&(u=new XRWebGLBinding(s,e)),u},this.getFrame=function(){return p},this.getSession=function(){return s},this.setSession=async function(J){if(s=J,s!==null){if(b=t.getRenderTarget(),s.addEventListener("select",z),s.addEventListener("selectstart",z),s.addEventListener("selectend",z),s.addEventListener("squeeze",z),s.addEventListener("squeezestart",z),s.addEventListener("squeezeend",z),s.addEventListener("end",W),s.addEventListener("inputsourceschange",et),y.xrCompatible!==!0&&await e.makeXRCompatible(),w=t.getPixelRatio(),t.getSize(x),_&&"createProjectionLayer"in XRWebGLBinding.prototype){let xt=null,Ct=null,mt=null;y.depth&&(mt=y.stencil?e.DEPTH24_STENCIL8:e.DEPTH_COMPONENT24,xt=y.stencil?Gi:Li,Ct=y.stencil?Us:ai);let Bt={colorFormat:e.RGBA8,depthFormat:mt,scaleFactor:r};u=this.getBinding(),d=u.createProjectionLayer(Bt),s.updateRenderState({layers:[d]}),t.setPixelRatio(1),t.setSize(d.textureWidth,d.textureHeight,!1),v=new Un(d.textureWidth,d.textureHeight,{format:sn,type:Bn,depthTexture:new Fi(d.textureWidth,d.textureHeight,Ct,void 0,void 0,void 0,void 0,void 0,void 0,xt),stencilBuffer:y.stencil,colorSpace:t.outputColorSpace,samples:y.antialias?4:0,resolveDepthBuffer:d.ignoreDepthValues===!1,resolveStencilBuffer:d.ignoreDepthValues===!1,storeMultisampledDepthBuffer:d.ignoreDepthValues===!1,storeMultisampledStencilBuffer:d.ignoreDepthValues===!1})}else{let xt={antialias:y.antialias,alpha:!0,depth:y.depth,stencil:y.stencil,framebufferScaleFactor:r};f=new XRWebGLLayer(s,e,xt),s.updateRenderState({baseLayer:f}),t.setPixelRatio(1),t.setSize(f.framebufferWidth,f.framebufferHeight,!1),v=new Un(f.framebufferWidth,f.framebufferHeight,{format:sn,type:Bn,colorSpace:t.outputColorSpace,stencilBuffer:y.stencil,resolveDepthBuffer:f.ignoreDepthValues===!1,resolveStencilBuffer:f.ignoreDepthValues===!1,storeMultisampledDepthBuffer:f.ignoreDepthValues===!1,storeMultisampledStencilBuffer:f.ignoreDepthValues===!1})}v.isXRRenderTarget=!0,this.setFoveation(l),c=null,o=await s.requestReferenceSpace(a),Ft.setContext(s),Ft.start(),n.isPresenting=!0,n.dispatchEvent({type:"sessionstart"})}},this.getEnvironmentBlendMode=function(){if(s!==null)return s.environmentBlendMode},this.getDepthTexture=function(){return m.getDepthTexture()};function et(J){for(let ut=0;ut<J.removed.length;ut++){let xt=J.removed[ut],Ct=A.indexOf(xt);Ct>=0&&(A[Ct]=null,M[Ct].disconnect(xt))}for(let ut=0;ut<J.added.length;ut++){let xt=J.added[ut],Ct=A.indexOf(xt);if(Ct===-1){for(let Bt=0;Bt<M.length;Bt++)if(Bt>=A.length){A.push(xt),Ct=Bt;break}else if(A[Bt]===null){A[Bt]=xt,Ct=Bt;break}if(Ct===-1)break}let mt=M[Ct];mt&&mt.connect(xt)}}function X(J,ut){ut===null?J.matrixWorld.copy(J.matrix):J.matrixWorld.multiplyMatrices(ut.matrixWorld,J.matrix),J.matrixWorldInverse.copy(J.matrixWorld).invert()}this.updateCamera=function(J){if(s===null)return;let ut=J.near,xt=J.far;m.texture!==null&&(m.depthNear>0&&(ut=m.depthNear),m.depthFar>0&&(xt=m.depthFar)),U.near=N.near=R.near=ut,U.far=N.far=R.far=xt,(L!==U.near||k!==U.far)&&(s.updateRenderState({depthNear:U.near,depthFar:U.far}),L=U.near,k=U.far),U.layers.mask=J.layers.mask|6,R.layers.mask=U.layers.mask&-5,N.layers.mask=U.layers.mask&-3;let Ct=J.parent,mt=U.cameras;X(U,Ct);for(let Bt=0;Bt<mt.length;Bt++)X(mt[Bt],Ct);U.projectionMatrix.copy(R.projectionMatrix),U.projectionMatrixInverse.copy(R.projectionMatrixInverse),D===null&&J.isPerspectiveCamera&&(D={camera:J,fov:J.fov,zoom:J.zoom}),Q(J,U,Ct)};function Q(J,ut,xt){xt===null?J.matrix.copy(ut.matrixWorld):(J.matrix.copy(xt.matrixWorld),J.matrix.invert(),J.matrix.multiply(ut.matrixWorld)),J.matrix.decompose(J.position,J.quaternion,J.scale),J.updateMatrixWorld(!0),J.projectionMatrix.copy(ut.projectionMatrix),J.projectionMatrixInverse.copy(ut.projectionMatrixInverse),J.isPerspectiveCamera&&(J.fov=mr*2*Math.atan(1/J.projectionMatrix.elements[5]),J.zoom=1)}this.getCamera=function(){return U},this.getFoveation=function(){if(!(d===null&&f===null))return l},this.setFoveation=function(J){l=J,d!==null&&(d.fixedFoveation=J),f!==null&&f.fixedFoveation!==void 0&&(f.fixedFoveation=J)},this.hasDepthSensing=function(){return m.texture!==null},this.getDepthSensingMesh=function(){return m.getMesh(U)},this.getCameraTexture=function(J){return g[J]};let tt=null;function vt(J,ut){if(h=ut.getViewerPose(c||o),p=ut,h!==null){let xt=h.views;f!==null&&(t.setRenderTargetFramebuffer(v,f.framebuffer),t.setRenderTarget(v));let Ct=!1;xt.length!==U.cameras.length&&(U.cameras.length=0,Ct=!0);for(let Lt=0;Lt<xt.length;Lt++){let Qt=xt[Lt],he=null;if(f!==null)he=f.getViewport(Qt);else{let Je=u.getViewSubImage(d,Qt);he=Je.viewport,Lt===0&&(t.setRenderTargetTextures(v,Je.colorTexture,Je.depthStencilTexture),t.setRenderTarget(v))}let qt=P[Lt];qt===void 0&&(qt=new _n,qt.layers.enable(Lt),qt.viewport=new de,P[Lt]=qt),qt.matrix.fromArray(Qt.transform.matrix),qt.matrix.decompose(qt.position,qt.quaternion,qt.scale),qt.projectionMatrix.fromArray(Qt.projectionMatrix),qt.projectionMatrixInverse.copy(qt.projectionMatrix).invert(),qt.viewport.set(he.x,he.y,he.width,he.height),Lt===0&&(U.matrix.copy(qt.matrix),U.matrix.decompose(U.position,U.quaternion,U.scale)),Ct===!0&&U.cameras.push(qt)}let mt=s.enabledFeatures;if(mt&&mt.includes("depth-sensing")&&s.depthUsage=="gpu-optimized"&&_){u=n.getBinding();let Lt=u.getDepthInformation(xt[0]);Lt&&Lt.isValid&&Lt.texture&&m.init(Lt,s.renderState)}if(mt&&mt.includes("camera-access")&&_){t.state.unbindTexture(),u=n.getBinding();for(let Lt=0;Lt<xt.length;Lt++){let Qt=xt[Lt].camera;if(Qt){let he=g[Qt];he||(he=new wo,g[Qt]=he);let qt=u.getCameraImage(Qt);he.sourceTexture=qt}}}}for(let xt=0;xt<M.length;xt++){let Ct=A[xt],mt=M[xt];Ct!==null&&mt!==void 0&&mt.update(Ct,ut,c||o)}tt&&tt(J,ut),ut.detectedPlanes&&n.dispatchEvent({type:"planesdetected",data:ut}),p=null}let Ft=new zm;Ft.setAnimationLoop(vt),this.setAnimationLoop=function(J){tt=J},this.dispose=function(){}}},MS=new Pt,Jm=new Ut;Jm.set(-1,0,0,0,1,0,0,0,1);function wS(i,t){function e(m,g){m.matrixAutoUpdate===!0&&m.updateMatrix(),g.value.copy(m.matrix)}function n(m,g){g.color.getRGB(m.fogColor.value,qu(i)),g.isFog?(m.fogNear.value=g.near,m.fogFar.value=g.far):g.isFogExp2&&(m.fogDensity.value=g.density)}function s(m,g,y,b,v){g.isNodeMaterial?g.uniformsNeedUpdate=!1:g.isMeshBasicMaterial?r(m,g):g.isMeshLambertMaterial?(r(m,g),g.envMap&&(m.envMapIntensity.value=g.envMapIntensity)):g.isMeshToonMaterial?(r(m,g),u(m,g)):g.isMeshPhongMaterial?(r(m,g),h(m,g),g.envMap&&(m.envMapIntensity.value=g.envMapIntensity)):g.isMeshStandardMaterial?(r(m,g),d(m,g),g.isMeshPhysicalMaterial&&f(m,g,v)):g.isMeshMatcapMaterial?(r(m,g),p(m,g)):g.isMeshDepthMaterial?r(m,g):g.isMeshDistanceMaterial?(r(m,g),_(m,g)):g.isMeshNormalMaterial?r(m,g):g.isLineBasicMaterial?(o(m,g),g.isLineDashedMaterial&&a(m,g)):g.isPointsMaterial?l(m,g,y,b):g.isSpriteMaterial?c(m,g):g.isShadowMaterial?(m.color.value.copy(g.color),m.opacity.value=g.opacity):g.isShaderMaterial&&(g.uniformsNeedUpdate=!1)}function r(m,g){m.opacity.value=g.opacity,g.color&&m.diffuse.value.copy(g.color),g.emissive&&m.emissive.value.copy(g.emissive).multiplyScalar(g.emissiveIntensity),g.map&&(m.map.value=g.map,e(g.map,m.mapTransform)),g.alphaMap&&(m.alphaMap.value=g.alphaMap,e(g.alphaMap,m.alphaMapTransform)),g.bumpMap&&(m.bumpMap.value=g.bumpMap,e(g.bumpMap,m.bumpMapTransform),m.bumpScale.value=g.bumpScale,g.side===nn&&(m.bumpScale.value*=-1)),g.normalMap&&(m.normalMap.value=g.normalMap,e(g.normalMap,m.normalMapTransform),m.normalScale.value.copy(g.normalScale),g.side===nn&&m.normalScale.value.negate()),g.displacementMap&&(m.displacementMap.value=g.displacementMap,e(g.displacementMap,m.displacementMapTransform),m.displacementScale.value=g.displacementScale,m.displacementBias.value=g.displacementBias),g.emissiveMap&&(m.emissiveMap.value=g.emissiveMap,e(g.emissiveMap,m.emissiveMapTransform)),g.specularMap&&(m.specularMap.value=g.specularMap,e(g.specularMap,m.specularMapTransform)),g.alphaTest>0&&(m.alphaTest.value=g.alphaTest);let y=t.get(g),b=y.envMap,v=y.envMapRotation;b&&(m.envMap.value=b,m.envMapRotation.value.setFromMatrix4(MS.makeRotationFromEuler(v)).transpose(),b.isCubeTexture&&b.isRenderTargetTexture===!1&&m.envMapRotation.value.premultiply(Jm),m.reflectivity.value=g.reflectivity,m.ior.value=g.ior,m.refractionRatio.value=g.refractionRatio),g.lightMap&&(m.lightMap.value=g.lightMap,m.lightMapIntensity.value=g.lightMapIntensity,e(g.lightMap,m.lightMapTransform)),g.aoMap&&(m.aoMap.value=g.aoMap,m.aoMapIntensity.value=g.aoMapIntensity,e(g.aoMap,m.aoMapTransform))}function o(m,g){m.diffuse.value.copy(g.color),m.opacity.value=g.opacity,g.map&&(m.map.value=g.map,e(g.map,m.mapTransform))}function a(m,g){m.dashSize.value=g.dashSize,m.totalSize.value=g.dashSize+g.gapSize,m.scale.value=g.scale}function l(m,g,y,b){m.diffuse.value.copy(g.color),m.opacity.value=g.opacity,m.size.value=g.size*y,m.scale.value=b*.5,g.map&&(m.map.value=g.map,e(g.map,m.uvTransform)),g.alphaMap&&(m.alphaMap.value=g.alphaMap,e(g.alphaMap,m.alphaMapTransform)),g.alphaTest>0&&(m.alphaTest.value=g.alphaTest)}function c(m,g){m.diffuse.value.copy(g.color),m.opacity.value=g.opacity,m.rotation.value=g.rotation,g.map&&(m.map.value=g.map,e(g.map,m.mapTransform)),g.alphaMap&&(m.alphaMap.value=g.alphaMap,e(g.alphaMap,m.alphaMapTransform)),g.alphaTest>0&&(m.alphaTest.value=g.alphaTest)}function h(m,g){m.specular.value.copy(g.specular),m.shininess.value=Math.max(g.shininess,1e-4)}function u(m,g){g.gradientMap&&(m.gradientMap.value=g.gradientMap)}function d(m,g){m.metalness.value=g.metalness,g.metalnessMap&&(m.metalnessMap.value=g.metalnessMap,e(g.metalnessMap,m.metalnessMapTransform)),m.roughness.value=g.roughness,g.roughnessMap&&(m.roughnessMap.value=g.roughnessMap,e(g.roughnessMap,m.roughnessMapTransform)),g.envMap&&(m.envMapIntensity.value=g.envMapIntensity)}function f(m,g,y){m.ior.value=g.ior,g.diffuseRoughness>0&&(m.diffuseRoughness.value=g.diffuseRoughness,g.diffuseRoughnessMap&&(m.diffuseRoughnessMap.value=g.diffuseRoughnessMap,e(g.diffuseRoughnessMap,m.diffuseRoughnessMapTransform))),g.sheen>0&&(m.sheenColor.value.copy(g.sheenColor).multiplyScalar(g.sheen),m.sheenRoughness.value=g.sheenRoughness,g.sheenColorMap&&(m.sheenColorMap.value=g.sheenColorMap,e(g.sheenColorMap,m.sheenColorMapTransform)),g.sheenRoughnessMap&&(m.sheenRoughnessMap.value=g.sheenRoughnessMap,e(g.sheenRoughnessMap,m.sheenRoughnessMapTransform))),g.clearcoat>0&&(m.clearcoat.value=g.clearcoat,m.clearcoatRoughness.value=g.clearcoatRoughness,g.clearcoatMap&&(m.clearcoatMap.value=g.clearcoatMap,e(g.clearcoatMap,m.clearcoatMapTransform)),g.clearcoatRoughnessMap&&(m.clearcoatRoughnessMap.value=g.clearcoatRoughnessMap,e(g.clearcoatRoughnessMap,m.clearcoatRoughnessMapTransform)),g.clearcoatNormalMap&&(m.clearcoatNormalMap.value=g.clearcoatNormalMap,e(g.clearcoatNormalMap,m.clearcoatNormalMapTransform),m.clearcoatNormalScale.value.copy(g.clearcoatNormalScale),g.side===nn&&m.clearcoatNormalScale.value.negate())),g.dispersion>0&&(m.dispersion.value=g.dispersion),g.retroreflectivity>0&&(m.retroreflectivity.value=g.retroreflectivity),g.iridescence>0&&(m.iridescence.value=g.iridescence,m.iridescenceIOR.value=g.iridescenceIOR,m.iridescenceThicknessMinimum.value=g.iridescenceThicknessMinimum,m.iridescenceThicknessMaximum.value=g.iridescenceThicknessMaximum,g.iridescenceMap&&(m.iridescenceMap.value=g.iridescenceMap,e(g.iridescenceMap,m.iridescenceMapTransform)),g.iridescenceThicknessMap&&(m.iridescenceThicknessMap.value=g.iridescenceThicknessMap,e(g.iridescenceThicknessMap,m.iridescenceThicknessMapTransform))),g.transmission>0&&(m.transmission.value=g.transmission,m.transmissionSamplerMap.value=y.texture,m.transmissionSamplerSize.value.set(y.width,y.height),g.transmissionMap&&(m.transmissionMap.value=g.transmissionMap,e(g.transmissionMap,m.transmissionMapTransform)),m.thickness.value=g.thickness,g.thicknessMap&&(m.thicknessMap.value=g.thicknessMap,e(g.thicknessMap,m.thicknessMapTransform)),m.attenuationDistance.value=g.attenuationDistance,m.attenuationColor.value.copy(g.attenuationColor)),g.anisotropy>0&&(m.anisotropyVector.value.set(g.anisotropy*Math.cos(g.anisotropyRotation),g.anisotropy*Math.sin(g.anisotropyRotation)),g.anisotropyMap&&(m.anisotropyMap.value=g.anisotropyMap,e(g.anisotropyMap,m.anisotropyMapTransform))),m.specularIntensity.value=g.specularIntensity,m.specularColor.value.copy(g.specularColor),g.specularColorMap&&(m.specularColorMap.value=g.specularColorMap,e(g.specularColorMap,m.specularColorMapTransform)),g.specularIntensityMap&&(m.specularIntensityMap.value=g.specularIntensityMap,e(g.specularIntensityMap,m.specularIntensityMapTransform))}function p(m,g){g.matcap&&(m.matcap.value=g.matcap)}function _(m,g){let y=t.get(g).light;m.referencePosition.value.setFromMatrixPosition(y.matrixWorld),m.nearDistance.value=y.shadow.camera.near,m.farDistance.value=y.shadow.camera.far}return{refreshFogUniforms:n,refreshMaterialUniforms:s}}function AS(i,t,e,n){let s={},r={};function o(y,b){let v=b.program;n.uniformBlockBinding(y,v,s[y.id])}function a(y,b){let v=s[y.id];v===void 0&&(p(y),v=l(y),s[y.id]=v,y.addEventListener("dispose",m));let M=b.program;n.updateUBOMapping(y,M);let A=t.render.frame;r[y.id]!==A&&(c(y),r[y.id]=A)}function l(y){let b=i.createBuffer(),v=y.__size,M=y.usage;return i.bindBuffer(i.UNIFORM_BUFFER,b),i.bufferData(i.UNIFORM_BUFFER,v,M),i.bindBuffer(i.UNIFORM_BUFFER,null),b}function c(y){let b=s[y.id],v=y.uniforms,M=y.__cache;i.bindBuffer(i.UNIFORM_BUFFER,b);for(let A=0,x=v.length;A<x;A++){let w=v[A];if(Array.isArray(w))for(let D=0,R=w.length;D<R;D++)h(w[D],A,D,M);else h(w,A,0,M)}i.bindBuffer(i.UNIFORM_BUFFER,null)}function h(y,b,v,M){if(d(y,b,v,M)===!0){let A=y.__offset,x=y.value;if(Array.isArray(x)){let w=0;for(let D=0;D<x.length;D++){let R=x[D],N=_(R,!0);u(R,y.__data,w),w+=N.storage/Float32Array.BYTES_PER_ELEMENT}}else u(x,y.__data,0);i.bufferSubData(i.UNIFORM_BUFFER,A,y.__data)}}function u(y,b,v){typeof y=="number"||typeof y=="boolean"?b[v]=y:y.isMatrix3?(b[v]=y.elements[0],b[v+1]=y.elements[1],b[v+2]=y.elements[2],b[v+3]=0,b[v+4]=y.elements[3],b[v+5]=y.elements[4],b[v+6]=y.elements[5],b[v+7]=0,b[v+8]=y.elements[6],b[v+9]=y.elements[7],b[v+10]=y.elements[8],b[v+11]=0):ArrayBuffer.isView(y)?b.set(y.subarray(0,b.length-v),v):y.toArray(b,v)}function d(y,b,v,M){let A=y.value,x=b+"_"+v;if(Array.isArray(A)){M[x]===void 0&&(M[x]=[]);let w=M[x],D=!1;for(let R=0;R<A.length;R++)f(A[R],w,R)===!0&&(D=!0);return D}return f(A,M,x)}function f(y,b,v){if(b[v]===void 0)return typeof y=="number"||typeof y=="boolean"?b[v]=y:ArrayBuffer.isView(y)?b[v]=y.slice():b[v]=y.clone(),!0;{let M=b[v];if(typeof y=="number"||typeof y=="boolean"){if(M!==y)return b[v]=y,!0}else{if(ArrayBuffer.isView(y))return!0;if(M.equals(y)===!1)return M.copy(y),!0}}return!1}function p(y){let b=y.uniforms,v=0,M=16;for(let x=0,w=b.length;x<w;x++){let D=Array.isArray(b[x])?b[x]:[b[x]];for(let R=0,N=D.length;R<N;R++){let P=D[R],U=Array.isArray(P.value)?P.value:[P.value],L=Array.isArray(b[x])||Array.isArray(P.value),k=v;for(let W=0,et=U.length;W<et;W++){let X=U[W],Q=_(X,L),tt=v%M,vt=tt%Q.boundary,Ft=tt+vt;v+=vt,Ft!==0&&M-Ft<Q.storage&&(v+=M-Ft),W===0&&(k=v),v+=Q.storage}let z=P.type==="int"?Int32Array:P.type==="uint"?Uint32Array:Float32Array;P.__data=new z((v-k)/Float32Array.BYTES_PER_ELEMENT),P.__offset=k}}let A=v%M;return A>0&&(v+=M-A),y.__size=v,y.__cache={},this}function _(y,b){let v={boundary:0,storage:0};return typeof y=="number"||typeof y=="boolean"?(v.boundary=4,v.storage=4):y.isVector2?(v.boundary=8,v.storage=8):y.isVector3||y.isColor?(v.boundary=16,v.storage=12):y.isVector4?(v.boundary=16,v.storage=16):y.isMatrix3?(v.boundary=16,v.storage=48):y.isMatrix4?(v.boundary=16,v.storage=64):y.isTexture?It("WebGLRenderer: Texture samplers can not be part of an uniforms group."):ArrayBuffer.isView(y)?(v.boundary=16,v.storage=y.byteLength):It("WebGLRenderer: Unsupported uniform value type.",y),b===!0&&(v.boundary=16,v.storage=Math.ceil(v.storage/16)*16),v}function m(y){let b=y.target;b.removeEventListener("dispose",m),i.deleteBuffer(s[b.id]),delete s[b.id],delete r[b.id]}function g(){for(let y in s)i.deleteBuffer(s[y]);s={},r={}}return{bind:o,update:a,dispose:g}}var ES=new Uint16Array([12469,15057,12620,14925,13266,14620,13807,14376,14323,13990,14545,13625,14713,13328,14840,12882,14931,12528,14996,12233,15039,11829,15066,11525,15080,11295,15085,10976,15082,10705,15073,10495,13880,14564,13898,14542,13977,14430,14158,14124,14393,13732,14556,13410,14702,12996,14814,12596,14891,12291,14937,11834,14957,11489,14958,11194,14943,10803,14921,10506,14893,10278,14858,9960,14484,14039,14487,14025,14499,13941,14524,13740,14574,13468,14654,13106,14743,12678,14818,12344,14867,11893,14889,11509,14893,11180,14881,10751,14852,10428,14812,10128,14765,9754,14712,9466,14764,13480,14764,13475,14766,13440,14766,13347,14769,13070,14786,12713,14816,12387,14844,11957,14860,11549,14868,11215,14855,10751,14825,10403,14782,10044,14729,9651,14666,9352,14599,9029,14967,12835,14966,12831,14963,12804,14954,12723,14936,12564,14917,12347,14900,11958,14886,11569,14878,11247,14859,10765,14828,10401,14784,10011,14727,9600,14660,9289,14586,8893,14508,8533,15111,12234,15110,12234,15104,12216,15092,12156,15067,12010,15028,11776,14981,11500,14942,11205,14902,10752,14861,10393,14812,9991,14752,9570,14682,9252,14603,8808,14519,8445,14431,8145,15209,11449,15208,11451,15202,11451,15190,11438,15163,11384,15117,11274,15055,10979,14994,10648,14932,10343,14871,9936,14803,9532,14729,9218,14645,8742,14556,8381,14461,8020,14365,7603,15273,10603,15272,10607,15267,10619,15256,10631,15231,10614,15182,10535,15118,10389,15042,10167,14963,9787,14883,9447,14800,9115,14710,8665,14615,8318,14514,7911,14411,7507,14279,7198,15314,9675,15313,9683,15309,9712,15298,9759,15277,9797,15229,9773,15166,9668,15084,9487,14995,9274,14898,8910,14800,8539,14697,8234,14590,7790,14479,7409,14367,7067,14178,6621,15337,8619,15337,8631,15333,8677,15325,8769,15305,8871,15264,8940,15202,8909,15119,8775,15022,8565,14916,8328,14804,8009,14688,7614,14569,7287,14448,6888,14321,6483,14088,6171,15350,7402,15350,7419,15347,7480,15340,7613,15322,7804,15287,7973,15229,8057,15148,8012,15046,7846,14933,7611,14810,7357,14682,7069,14552,6656,14421,6316,14251,5948,14007,5528,15356,5942,15356,5977,15353,6119,15348,6294,15332,6551,15302,6824,15249,7044,15171,7122,15070,7050,14949,6861,14818,6611,14679,6349,14538,6067,14398,5651,14189,5311,13935,4958,15359,4123,15359,4153,15356,4296,15353,4646,15338,5160,15311,5508,15263,5829,15188,6042,15088,6094,14966,6001,14826,5796,14678,5543,14527,5287,14377,4985,14133,4586,13869,4257,15360,1563,15360,1642,15358,2076,15354,2636,15341,3350,15317,4019,15273,4429,15203,4732,15105,4911,14981,4932,14836,4818,14679,4621,14517,4386,14359,4156,14083,3795,13808,3437,15360,122,15360,137,15358,285,15355,636,15344,1274,15322,2177,15281,2765,15215,3223,15120,3451,14995,3569,14846,3567,14681,3466,14511,3305,14344,3121,14037,2800,13753,2467,15360,0,15360,1,15359,21,15355,89,15346,253,15325,479,15287,796,15225,1148,15133,1492,15008,1749,14856,1882,14685,1886,14506,1783,14324,1608,13996,1398,13702,1183]),yi=null;function TS(){return yi===null&&(yi=new mi(ES,16,16,_i,li),yi.name="DFG_LUT",yi.minFilter=yn,yi.magFilter=yn,yi.wrapS=pi,yi.wrapT=pi,yi.generateMipmaps=!1,yi.needsUpdate=!0),yi}var Cc=class{constructor(t={}){let{canvas:e=um(),context:n=null,depth:s=!0,stencil:r=!1,alpha:o=!1,antialias:a=!1,premultipliedAlpha:l=!0,preserveDrawingBuffer:c=!1,powerPreference:h="default",failIfMajorPerformanceCaveat:u=!1,reversedDepthBuffer:d=!1,outputBufferType:f=Bn}=t;this.isWebGLRenderer=!0;let p;if(n!==null){if(typeof WebGLRenderingContext<"u"&&n instanceof WebGLRenderingContext)throw new Error("THREE.WebGLRenderer: WebGL 1 is not supported since r163.");p=n.getContextAttributes().alpha}else p=o;let _=f,m=new Set([Yl,ql,Xl]),g=new Set([Bn,ai,Ar,Us,Wl,$l]),y=new Uint32Array(4),b=new Int32Array(4),v={textures:[],min:[],max:[],resolution:[]},M=null,A=null,x=[],w=[],D=null;this.domElement=e,this.debug={checkShaderErrors:!0,diagnostics:{keywords:!1},onShaderError:null},this.autoClear=!0,this.autoClearColor=!0,this.autoClearDepth=!0,this.autoClearStencil=!0,this.sortObjects=!0,this.clippingPlanes=[],this.localClippingEnabled=!1,this.toneMapping=gi,this.toneMappingExposure=1,this.transmissionResolutionScale=1;let R=this,N=!1,P=null,U=null,L=null,k=null;this._outputColorSpace=Fn;let z=0,W=0,et=null,X=-1,Q=null,tt=new de,vt=new de,Ft=null,J=new Kt(0),ut=0,xt=e.width,Ct=e.height,mt=1,Bt=null,Ce=null,Lt=new de(0,0,xt,Ct),Qt=new de(0,0,xt,Ct),he=!1,qt=new Ls,Je=new vl,Be=!1,wn=!1,we=new Pt,di=new C,We=new de,Hn={background:null,fog:null,environment:null,overrideMaterial:null,isScene:!0},Wn=!1;function $n(){return et===null?mt:1}let B=n;function Xn(T,O){return e.getContext(T,O)}let ve,be,pt,ke,Dt,kt,I,E,G,it,j,ot,dt,Y,Z,lt,F,K,q,ct,rt,at,Et;try{let T={alpha:!0,depth:s,stencil:r,antialias:a,premultipliedAlpha:l,preserveDrawingBuffer:c,powerPreference:h,failIfMajorPerformanceCaveat:u};if("setAttribute"in e&&e.setAttribute("data-engine",`three.js r${"187"}`),e.addEventListener("webglcontextlost",Rt,!1),e.addEventListener("webglcontextrestored",Gt,!1),e.addEventListener("webglcontextcreationerror",gt,!1),B===null){let O="webgl2";if(B=Xn(O,T),B===null)throw Xn(O)?new Error("THREE.WebGLRenderer: Error creating WebGL context with your selected attributes."):new Error("THREE.WebGLRenderer: Error creating WebGL context.")}Wt()}catch(T){throw e.removeEventListener("webglcontextlost",Rt,!1),e.removeEventListener("webglcontextrestored",Gt,!1),e.removeEventListener("webglcontextcreationerror",gt,!1),Nt("WebGLRenderer: "+T.message),T}function Wt(){ve=new Bv(B),ve.init(),rt=new vS(B,ve),be=new Tv(B,ve,t,rt),pt=new yS(B,ve),be.reversedDepthBuffer&&d&&pt.buffers.depth.setReversed(!0),U=B.createFramebuffer(),L=B.createFramebuffer(),k=B.createFramebuffer(),ke=new Vv(B),Dt=new sS,kt=new xS(B,ve,pt,Dt,be,rt,ke),I=new Ov(R),E=new H_(B),at=new Av(B,E),G=new kv(B,E,ke,at),it=new Hv(B,G,E,at,ke),K=new Gv(B,be,kt),Z=new Rv(Dt),j=new iS(R,I,ve,be,at,Z),ot=new wS(R,Dt),dt=new oS,Y=new dS(ve),F=new wv(R,I,pt,it,p,l),lt=new _S(R,it,be),Et=new AS(B,ke,be,pt),q=new Ev(B,ve,ke),ct=new zv(B,ve,ke),ke.programs=j.programs,R.capabilities=be,R.extensions=ve,R.properties=Dt,R.renderLists=dt,R.shadowMap=lt,R.state=pt,R.info=ke}_!==Bn&&(D=new $v(_,e.width,e.height,a,s,r));let st=new od(R,B);this.xr=st,this.getContext=function(){return B},this.getContextAttributes=function(){return B.getContextAttributes()},this.forceContextLoss=function(){let T=ve.get("WEBGL_lose_context");T&&T.loseContext()},this.forceContextRestore=function(){let T=ve.get("WEBGL_lose_context");T&&T.restoreContext()},this.getPixelRatio=function(){return mt},this.setPixelRatio=function(T){T!==void 0&&(mt=T,this.setSize(xt,Ct,!1))},this.getSize=function(T){return T.set(xt,Ct)},this.setSize=function(T,O,$=!0){if(st.isPresenting){It("WebGLRenderer: Can't change size while VR device is presenting.");return}xt=T,Ct=O,e.width=Math.floor(T*mt),e.height=Math.floor(O*mt),$===!0&&(e.style.width=T+"px",e.style.height=O+"px"),D!==null&&D.setSize(e.width,e.height),this.setViewport(0,0,T,O)},this.getDrawingBufferSize=function(T){return T.set(xt*mt,Ct*mt).floor()},this.setDrawingBufferSize=function(T,O,$){xt=T,Ct=O,mt=$,e.width=Math.floor(T*$),e.height=Math.floor(O*$),this.setViewport(0,0,T,O)},this.setEffects=function(T){if(_===Bn){Nt("WebGLRenderer: setEffects() requires outputBufferType set to HalfFloatType or FloatType.");return}if(T){for(let O=0;O<T.length;O++)if(T[O].isOutputPass===!0){It("WebGLRenderer: OutputPass is not needed in setEffects(). Tone mapping and color space conversion are applied automatically.");break}}D.setEffects(T||[])},this.getCurrentViewport=function(T){return T.copy(tt)},this.getViewport=function(T){return T.copy(Lt)},this.setViewport=function(T,O,$,V){T.isVector4?Lt.set(T.x,T.y,T.z,T.w):Lt.set(T,O,$,V),pt.viewport(tt.copy(Lt).multiplyScalar($n()).round())},this.getScissor=function(T){return T.copy(Qt)},this.setScissor=function(T,O,$,V){T.isVector4?Qt.set(T.x,T.y,T.z,T.w):Qt.set(T,O,$,V),pt.scissor(vt.copy(Qt).multiplyScalar($n()).round())},this.getScissorTest=function(){return he},this.setScissorTest=function(T){pt.setScissorTest(he=T)},this.setOpaqueSort=function(T){Bt=T},this.setTransparentSort=function(T){Ce=T},this.getClearColor=function(T){return T.copy(F.getClearColor())},this.setClearColor=function(){F.setClearColor(...arguments)},this.getClearAlpha=function(){return F.getClearAlpha()},this.setClearAlpha=function(){F.setClearAlpha(...arguments)},this.clear=function(T=!0,O=!0,$=!0){let V=0;if(T){let H=!1;if(et!==null){let ft=et.texture.format;H=m.has(ft)}if(H){let ft=et.texture.type,bt=g.has(ft),ht=F.getClearColor(),yt=F.getClearAlpha(),At=ht.r,zt=ht.g,Yt=ht.b;bt?(y[0]=At,y[1]=zt,y[2]=Yt,y[3]=yt,B.clearBufferuiv(B.COLOR,0,y)):(b[0]=At,b[1]=zt,b[2]=Yt,b[3]=yt,B.clearBufferiv(B.COLOR,0,b))}else V|=B.COLOR_BUFFER_BIT}O&&(V|=B.DEPTH_BUFFER_BIT,this.state.buffers.depth.setMask(!0)),$&&(V|=B.STENCIL_BUFFER_BIT,this.state.buffers.stencil.setMask(4294967295)),V!==0&&B.clear(V)},this.clearColor=function(){this.clear(!0,!1,!1)},this.clearDepth=function(){this.clear(!1,!0,!1)},this.clearStencil=function(){this.clear(!1,!1,!0)},this.setNodesHandler=function(T){T.setRenderer(this),P=T},this.dispose=function(){e.removeEventListener("webglcontextlost",Rt,!1),e.removeEventListener("webglcontextrestored",Gt,!1),e.removeEventListener("webglcontextcreationerror",gt,!1),F.dispose(),dt.dispose(),Y.dispose(),kt.dispose(),Dt.dispose(),I.dispose(),it.dispose(),G.dispose(),at.dispose(),Et.dispose(),j.dispose(),st.dispose(),st.removeEventListener("sessionstart",sf),st.removeEventListener("sessionend",rf),bs.stop()};function Rt(T){T.preventDefault(),mo("WebGLRenderer: Context Lost."),N=!0}function Gt(){mo("WebGLRenderer: Context Restored."),N=!1;let T=ke.autoReset,O=lt.enabled,$=lt.autoUpdate,V=lt.needsUpdate,H=lt.type;Wt(),ke.autoReset=T,lt.enabled=O,lt.autoUpdate=$,lt.needsUpdate=V,lt.type=H}function gt(T){Nt("WebGLRenderer: A WebGL context could not be created. Reason: ",T.statusMessage)}function le(T){let O=T.target;O.removeEventListener("dispose",le),$e(O)}function $e(T){qi(T),Dt.remove(T)}function qi(T){let O=Dt.get(T).programs;O!==void 0&&(O.forEach(function($){j.releaseProgram($)}),T.isShaderMaterial&&j.releaseShaderCache(T))}this.renderBufferDirect=function(T,O,$,V,H,ft){O===null&&(O=Hn);let bt=H.isMesh&&H.matrixWorld.determinantAffine()<0,ht=C0(T,O,$,V,H);pt.setMaterial(V,bt);let yt=$.index,At=1;if(V.wireframe===!0){if(yt=G.getWireframeAttribute($),yt===void 0)return;At=2}let zt=$.drawRange,Yt=$.attributes.position,Mt=zt.start*At,Zt=(zt.start+zt.count)*At;ft!==null&&(Mt=Math.max(Mt,ft.start*At),Zt=Math.min(Zt,(ft.start+ft.count)*At)),yt!==null?(Mt=Math.max(Mt,0),Zt=Math.min(Zt,yt.count)):Yt!=null&&(Mt=Math.max(Mt,0),Zt=Math.min(Zt,Yt.count));let De=Zt-Mt;if(De<0||De===1/0)return;at.setup(H,V,ht,$,yt);let me,ue=q;if(yt!==null&&(me=E.get(yt),ue=ct,ue.setIndex(me)),H.isMesh)V.wireframe===!0?(pt.setLineWidth(V.wireframeLinewidth*$n()),ue.setMode(B.LINES)):ue.setMode(B.TRIANGLES);else if(H.isLine){let an=V.linewidth;an===void 0&&(an=1),pt.setLineWidth(an*$n()),H.isLineSegments?ue.setMode(B.LINES):H.isLineLoop?ue.setMode(B.LINE_LOOP):ue.setMode(B.LINE_STRIP)}else H.isPoints?ue.setMode(B.POINTS):H.isSprite&&ue.setMode(B.TRIANGLES);if(H.isBatchedMesh)if(ve.get("WEBGL_multi_draw"))ue.renderMultiDraw(H._multiDrawStarts,H._multiDrawCounts,H._multiDrawCount);else{let an=H._multiDrawStarts,wt=H._multiDrawCounts,pn=H._multiDrawCount,ee=yt?E.get(yt).bytesPerElement:1,Ss=Dt.get(V).currentProgram.getUniforms();for(let ln=0;ln<pn;ln++)Ss.setValue(B,"_gl_DrawID",ln),ue.render(an[ln]/ee,wt[ln])}else if(H.isInstancedMesh)ue.renderInstances(Mt,De,H.count);else if($.isInstancedBufferGeometry){let an=$._maxInstanceCount!==void 0?$._maxInstanceCount:1/0,wt=Math.min($.instanceCount,an);ue.renderInstances(Mt,De,wt)}else ue.render(Mt,De)};function nf(T,O,$,V){P!==null&&T.isNodeMaterial&&P.setObject(V,T),Be===!0&&Z.setState(T,$,!1),T.transparent===!0&&T.side===Te&&T.forceSinglePass===!1?(T.side=nn,T.needsUpdate=!0,Jr(T,O,V),T.side=oi,T.needsUpdate=!0,Jr(T,O,V),T.side=Te):Jr(T,O,V)}this.compile=function(T,O,$=null){$===null&&($=T),P!==null&&P.renderStart(T,O,$),A=Y.get($),A.init(O),w.push(A),$.traverseVisible(function(H){H.isLight&&H.layers.test(O.layers)&&(A.pushLight(H),H.castShadow&&A.pushShadow(H))}),T!==$&&T.traverseVisible(function(H){H.isLight&&H.layers.test(O.layers)&&(A.pushLight(H),H.castShadow&&A.pushShadow(H))}),A.setupLights(),P!==null&&P.updateLights(A.state.lightsArray),wn=this.localClippingEnabled,Be=Z.init(this.clippingPlanes,wn),Be===!0&&Z.setGlobalState(this.clippingPlanes,O),P!==null&&lt.render(A.state.shadowsArray,$,O);let V=new Set;return T.traverse(function(H){if(!(H.isMesh||H.isPoints||H.isLine||H.isSprite))return;let ft=H.material;if(ft)if(Array.isArray(ft))for(let bt=0;bt<ft.length;bt++){let ht=ft[bt];nf(ht,$,O,H),V.add(ht)}else nf(ft,$,O,H),V.add(ft)}),A=w.pop(),P!==null&&P.renderEnd(),V},this.compileAsync=function(T,O,$=null){let V=this.compile(T,O,$);return new Promise(H=>{function ft(){if(V.forEach(function(bt){let yt=Dt.get(bt).currentProgram;(yt===void 0||yt.isReady())&&V.delete(bt)}),V.size===0){H(T);return}setTimeout(ft,10)}ve.get("KHR_parallel_shader_compile")!==null?ft():setTimeout(ft,10)})};let Ah=null;function T0(T){Ah&&Ah(T)}function sf(){bs.stop()}function rf(){bs.start()}let bs=new zm;bs.setAnimationLoop(T0),typeof self<"u"&&bs.setContext(self),this.setAnimationLoop=function(T){Ah=T,st.setAnimationLoop(T),T===null?bs.stop():bs.start()},st.addEventListener("sessionstart",sf),st.addEventListener("sessionend",rf),this.render=function(T,O){if(O!==void 0&&O.isCamera!==!0){Nt("WebGLRenderer.render: camera is not an instance of THREE.Camera.");return}if(N===!0)return;P!==null&&P.renderStart(T,O);let $=st.enabled===!0&&st.isPresenting===!0,V=D!==null&&(et===null||$)&&D.begin(R,et);if(T.matrixWorldAutoUpdate===!0&&T.updateMatrixWorld(),O.parent===null&&O.matrixWorldAutoUpdate===!0&&O.updateMatrixWorld(),st.enabled===!0&&st.isPresenting===!0&&(D===null||D.isCompositing()===!1)&&(st.cameraAutoUpdate===!0&&st.updateCamera(O),O=st.getCamera()),T.isScene===!0&&T.onBeforeRender(R,T,O,et),A=Y.get(T,w.length),A.init(O),A.state.textureUnits=kt.getTextureUnits(),w.push(A),we.multiplyMatrices(O.projectionMatrix,O.matrixWorldInverse),O.isArrayCamera?Je.setFromArrayCamera(O):qt.setFromProjectionMatrix(we,Jn,O.reversedDepth),wn=this.localClippingEnabled,Be=Z.init(this.clippingPlanes,wn),M=dt.get(T,x.length),M.init(),x.push(M),this.info.render.frame++,st.enabled===!0&&st.isPresenting===!0){let bt=R.xr.getDepthSensingMesh();bt!==null&&Eh(bt,O,-1/0,R.sortObjects)}Eh(T,O,0,R.sortObjects),M.finish(),P!==null&&P.updateLights(A.state.lightsArray),R.sortObjects===!0&&M.sort(Bt,Ce),Wn=st.enabled===!1||st.isPresenting===!1||st.hasDepthSensing()===!1,Wn&&F.addToRenderList(M,T),this.info.autoReset===!0&&this.info.reset(),Be===!0&&Z.beginShadows();let H=A.state.shadowsArray;if(lt.render(H,T,O),Be===!0&&Z.endShadows(),(V&&D.hasRenderPass())===!1){let bt=M.opaque,ht=M.transmissive;if(A.setupLights(),O.isArrayCamera){let yt=O.cameras;if(ht.length>0)for(let At=0,zt=yt.length;At<zt;At++){let Yt=yt[At];af(bt,ht,T,Yt)}Wn&&F.render(T);for(let At=0,zt=yt.length;At<zt;At++){let Yt=yt[At];of(M,T,Yt,Yt.viewport)}}else ht.length>0&&af(bt,ht,T,O),Wn&&F.render(T),of(M,T,O)}et!==null&&W===0&&(kt.updateMultisampleRenderTarget(et),kt.updateRenderTargetMipmap(et)),V&&D.end(R),T.isScene===!0&&T.onAfterRender(R,T,O),at.resetDefaultState(),X=-1,Q=null,w.pop(),w.length>0?(A=w[w.length-1],kt.setTextureUnits(A.state.textureUnits),Be===!0&&Z.setGlobalState(R.clippingPlanes,A.state.camera)):A=null,x.pop(),x.length>0?M=x[x.length-1]:M=null,P!==null&&P.renderEnd()};function Eh(T,O,$,V){if(T.visible===!1)return;if(T.layers.test(O.layers)){if(T.isGroup)$=T.renderOrder;else if(T.isLOD)T.autoUpdate===!0&&T.update(O);else if(T.isLight)A.pushLight(T),T.castShadow&&A.pushShadow(T);else if(T.isSprite){let bt=O.isArrayCamera?Je:qt;if(!T.frustumCulled||T.intersectsFrustum(bt)){V&&We.setFromMatrixPosition(T.matrixWorld).applyMatrix4(we);let ht=it.update(T),yt=T.material;yt.visible&&M.push(T,ht,yt,$,We.z,null,O)}}else if(T.isMesh||T.isLine||T.isPoints){let bt=O.isArrayCamera?Je:qt;if(!T.frustumCulled||T.intersectsFrustum(bt)){let ht=it.update(T),yt=T.material;if(V&&(T.boundingSphere!==void 0?(T.boundingSphere===null&&T.computeBoundingSphere(),We.copy(T.boundingSphere.center)):(ht.boundingSphere===null&&ht.computeBoundingSphere(),We.copy(ht.boundingSphere.center)),We.applyMatrix4(T.matrixWorld).applyMatrix4(we)),Array.isArray(yt)){let At=ht.groups;for(let zt=0,Yt=At.length;zt<Yt;zt++){let Mt=At[zt],Zt=yt[Mt.materialIndex];Zt&&Zt.visible&&M.push(T,ht,Zt,$,We.z,Mt,O)}}else yt.visible&&M.push(T,ht,yt,$,We.z,null,O)}}}let ft=T.children;for(let bt=0,ht=ft.length;bt<ht;bt++)Eh(ft[bt],O,$,V)}function of(T,O,$,V){let{opaque:H,transmissive:ft,transparent:bt}=T;A.setupLightsView($),Be===!0&&Z.setGlobalState(R.clippingPlanes,$),V&&pt.viewport(tt.copy(V)),H.length>0&&la(H,O,$),ft.length>0&&la(ft,O,$),bt.length>0&&la(bt,O,$),pt.buffers.depth.setTest(!0),pt.buffers.depth.setMask(!0),pt.buffers.color.setMask(!0),pt.setPolygonOffset(!1)}function af(T,O,$,V){if(($.isScene===!0?$.overrideMaterial:null)!==null)return;if(A.state.transmissionRenderTarget[V.id]===void 0){let Mt=ve.has("EXT_color_buffer_half_float")||ve.has("EXT_color_buffer_float");A.state.transmissionRenderTarget[V.id]=new Un(1,1,{generateMipmaps:!0,type:Mt?li:Bn,minFilter:Vi,samples:Math.max(4,be.samples),stencilBuffer:r,resolveDepthBuffer:!1,resolveStencilBuffer:!1,storeMultisampledDepthBuffer:!1,storeMultisampledStencilBuffer:!1,colorSpace:Jt.workingColorSpace})}let ft=A.state.transmissionRenderTarget[V.id],bt=V.viewport||tt;ft.setSize(bt.z*R.transmissionResolutionScale,bt.w*R.transmissionResolutionScale);let ht=R.getRenderTarget(),yt=R.getActiveCubeFace(),At=R.getActiveMipmapLevel();R.setRenderTarget(ft),R.getClearColor(J),ut=R.getClearAlpha(),ut<1&&R.setClearColor(16777215,.5),R.clear(),Wn&&F.render($);let zt=R.toneMapping;R.toneMapping=gi;let Yt=V.viewport;if(V.viewport!==void 0&&(V.viewport=void 0),A.setupLightsView(V),Be===!0&&Z.setGlobalState(R.clippingPlanes,V),la(T,$,V),kt.updateMultisampleRenderTarget(ft),kt.updateRenderTargetMipmap(ft),ve.has("WEBGL_multisampled_render_to_texture")===!1){let Mt=!1;for(let Zt=0,De=O.length;Zt<De;Zt++){let me=O[Zt],{object:ue,geometry:an,material:wt,group:pn}=me;if(wt.side===Te&&ue.layers.test(V.layers)){let ee=wt.side;wt.side=nn,wt.needsUpdate=!0,lf(ue,$,V,an,wt,pn),wt.side=ee,wt.needsUpdate=!0,Mt=!0}}Mt===!0&&(kt.updateMultisampleRenderTarget(ft),kt.updateRenderTargetMipmap(ft))}R.setRenderTarget(ht,yt,At),R.setClearColor(J,ut),Yt!==void 0&&(V.viewport=Yt),R.toneMapping=zt}function la(T,O,$){let V=O.isScene===!0?O.overrideMaterial:null;for(let H=0,ft=T.length;H<ft;H++){let bt=T[H],{object:ht,geometry:yt,group:At}=bt,zt=bt.material;zt.allowOverride===!0&&V!==null&&(zt=V),ht.layers.test($.layers)&&lf(ht,O,$,yt,zt,At)}}function lf(T,O,$,V,H,ft){P!==null&&H.isNodeMaterial&&P.setObject(T,H),T.onBeforeRender(R,O,$,V,H,ft),T.modelViewMatrix.multiplyMatrices($.matrixWorldInverse,T.matrixWorld),T.normalMatrix.getNormalMatrix(T.modelViewMatrix),H.onBeforeRender(R,O,$,V,T,ft),H.transparent===!0&&H.side===Te&&H.forceSinglePass===!1?(H.side=nn,H.needsUpdate=!0,R.renderBufferDirect($,O,V,H,T,ft),H.side=oi,H.needsUpdate=!0,R.renderBufferDirect($,O,V,H,T,ft),H.side=Te):R.renderBufferDirect($,O,V,H,T,ft),T.onAfterRender(R,O,$,V,H,ft)}function cf(T){let O=0;for(let $ of T)$.texture!==null&&O++;return O}function Jr(T,O,$){O.isScene!==!0&&(O=Hn);let V=Dt.get(T),H=A.state.lights,ft=A.state.shadowsArray,bt=H.state.version,ht=j.getParameters(T,H.state,ft,O,$,A.state.lightProbeGridArray),yt=j.getProgramCacheKey(ht),At=V.programs;V.environment=T.isMeshStandardMaterial||T.isMeshLambertMaterial||T.isMeshPhongMaterial?O.environment:null,V.fog=O.fog;let zt=T.isMeshStandardMaterial||T.isMeshLambertMaterial&&!T.envMap||T.isMeshPhongMaterial&&!T.envMap;V.envMap=I.get(T.envMap||V.environment,zt),V.envMapRotation=V.environment!==null&&T.envMap===null?O.environmentRotation:T.envMapRotation,At===void 0&&(T.addEventListener("dispose",le),At=new Map,V.programs=At,V.programVariants=new Map);let Yt=At.get(yt);if(Yt!==void 0){if(V.currentProgram===Yt&&V.lightsStateVersion===bt)return uf(T,ht),Yt}else ht.uniforms=j.getUniforms(T),P!==null&&T.isNodeMaterial&&P.build(T,$,ht),T.onBeforeCompile(ht,R),Yt=j.acquireProgram(ht,yt),At.set(yt,Yt),V.uniforms=ht.uniforms;let Mt=V.uniforms;return(!T.isShaderMaterial&&!T.isRawShaderMaterial||T.clipping===!0)&&(Mt.clippingPlanes=Z.uniform),uf(T,ht),V.needsLights=I0(T),V.lightsStateVersion=bt,V.needsLights&&(Mt.ambientLightColor.value=H.state.ambient,Mt.lightProbe.value=H.state.probe,Mt.sunLights.value=H.state.sun,Mt.sunLightShadows.value=H.state.sunShadow,Mt.directionalLights.value=H.state.directional,Mt.directionalLightShadows.value=H.state.directionalShadow,Mt.spotLights.value=H.state.spot,Mt.spotLightShadows.value=H.state.spotShadow,Mt.rectAreaLights.value=H.state.rectArea,Mt.ltc_1.value=H.state.rectAreaLTC1,Mt.ltc_2.value=H.state.rectAreaLTC2,Mt.pointLights.value=H.state.point,Mt.pointLightShadows.value=H.state.pointShadow,Mt.hemisphereLights.value=H.state.hemi,Mt.sunShadowMatrix.value=H.state.sunShadowMatrix,Mt.sunShadowCascade.value=H.state.sunShadowCascade,Mt.directionalShadowMatrix.value=H.state.directionalShadowMatrix,Mt.spotLightMatrix.value=H.state.spotLightMatrix,Mt.spotLightMap.value=H.state.spotLightMap,Mt.pointShadowMatrix.value=H.state.pointShadowMatrix),V.numLightProbeGrids=cf(A.state.lightProbeGridArray),V.currentProgram=Yt,V.uniformsList=null,Yt}function R0(T,O,$,V,H){let ft=Dt.get(T),bt=ft.currentProgram.id+","+V+","+H,ht=ft.programVariants.get(bt);return ht===void 0?(ht=Jr(T,O,$),ft.programVariants.set(bt,ht)):(ft.currentProgram=ht,ft.uniformsList=null,ft.outputColorSpace=V,ft.toneMapping=H),ht}function hf(T){if(T.uniformsList===null){let O=T.currentProgram.getUniforms();T.uniformsList=Er.seqWithValue(O.seq,T.uniforms)}return T.uniformsList}function uf(T,O){let $=Dt.get(T);$.outputColorSpace=O.outputColorSpace,$.batching=O.batching,$.batchingColor=O.batchingColor,$.instancing=O.instancing,$.instancingColor=O.instancingColor,$.instancingMorph=O.instancingMorph,$.skinning=O.skinning,$.morphTargets=O.morphTargets,$.morphNormals=O.morphNormals,$.morphColors=O.morphColors,$.morphTargetsCount=O.morphTargetsCount,$.numClippingPlanes=O.numClippingPlanes,$.numIntersection=O.numClipIntersection,$.vertexAlphas=O.vertexAlphas,$.vertexTangents=O.vertexTangents,$.toneMapping=O.toneMapping}function C0(T,O,$,V,H){O.isScene!==!0&&(O=Hn),kt.resetTextureUnits();let ft=O.fog,bt=V.isMeshStandardMaterial||V.isMeshLambertMaterial||V.isMeshPhongMaterial?O.environment:null,ht=et===null?R.outputColorSpace:et.isXRRenderTarget===!0?et.texture.colorSpace:Jt.workingColorSpace,yt=V.isMeshStandardMaterial||V.isMeshLambertMaterial&&!V.envMap||V.isMeshPhongMaterial&&!V.envMap,At=I.get(V.envMap||bt,yt),zt=V.vertexColors===!0&&!!$.attributes.color&&$.attributes.color.itemSize===4,Yt=!!$.attributes.tangent&&(!!V.normalMap||V.anisotropy>0),Mt=!!$.morphAttributes.position,Zt=!!$.morphAttributes.normal,De=!!$.morphAttributes.color,me=gi;V.toneMapped&&(et===null||et.isXRRenderTarget===!0)&&(me=R.toneMapping);let ue=$.morphAttributes.position||$.morphAttributes.normal||$.morphAttributes.color,an=ue!==void 0?ue.length:0,wt=Dt.get(V),pn=A.state.lights;if(Be===!0&&(wn===!0||T!==Q)){let Ae=T===Q&&V.id===X;Z.setState(V,T,Ae)}let ee=!1,Ss=!1;V.version===wt.__version?wt.needsLights&&wt.lightsStateVersion!==pn.state.version||H.isBatchedMesh&&wt.batching===!1||!H.isBatchedMesh&&wt.batching===!0||H.isBatchedMesh&&wt.batchingColor===!0&&H._colorsTexture===null||H.isBatchedMesh&&wt.batchingColor===!1&&H._colorsTexture!==null||H.isInstancedMesh&&wt.instancing===!1||!H.isInstancedMesh&&wt.instancing===!0||H.isSkinnedMesh&&wt.skinning===!1||!H.isSkinnedMesh&&wt.skinning===!0||H.isInstancedMesh&&wt.instancingColor===!0&&H.instanceColor===null||H.isInstancedMesh&&wt.instancingColor===!1&&H.instanceColor!==null||H.isInstancedMesh&&wt.instancingMorph===!0&&H.morphTexture===null||H.isInstancedMesh&&wt.instancingMorph===!1&&H.morphTexture!==null||wt.envMap!==At||V.fog===!0&&wt.fog!==ft||wt.numClippingPlanes!==void 0&&(wt.numClippingPlanes!==Z.numPlanes||wt.numIntersection!==Z.numIntersection)||wt.vertexAlphas!==zt||wt.vertexTangents!==Yt||wt.morphTargets!==Mt||wt.morphNormals!==Zt||wt.morphColors!==De||wt.morphTargetsCount!==an||wt.numLightProbeGrids!==cf(A.state.lightProbeGridArray)?ee=!0:(wt.outputColorSpace!==ht||wt.toneMapping!==me)&&(Ss=!0):(ee=!0,wt.__version=V.version);let ln=wt.currentProgram;(ee===!0||Ss===!0)&&(ln=Ss===!0?R0(V,O,H,ht,me):Jr(V,O,H),P&&V.isNodeMaterial&&P.onUpdateProgram(V,ln,wt));let ca=!1,Yi=!1,Ms=!1,te=ln.getUniforms(),Ke=wt.uniforms;if(pt.useProgram(ln.program)&&(ca=!0,Yi=!0,Ms=!0),V.id!==X&&(X=V.id,Yi=!0),ca||Q!==T){pt.buffers.depth.getReversed()&&T.reversedDepth!==!0&&(T._reversedDepth=!0,T.updateProjectionMatrix()),te.setValue(B,"projectionMatrix",T.projectionMatrix),te.setValue(B,"viewMatrix",T.matrixWorldInverse);let Xe=te.map.cameraPosition;Xe!==void 0&&Xe.setValue(B,di.setFromMatrixPosition(T.matrixWorld)),be.logarithmicDepthBuffer&&te.setValue(B,"logDepthBufFC",2/(Math.log(T.far+1)/Math.LN2)),(V.isMeshPhongMaterial||V.isMeshToonMaterial||V.isMeshLambertMaterial||V.isMeshBasicMaterial||V.isMeshStandardMaterial||V.isShaderMaterial)&&te.setValue(B,"isOrthographic",T.isOrthographicCamera===!0),Q!==T&&(Q=T,Yi=!0,Ms=!0)}if(wt.needsLights&&(pn.state.sunShadowMap.length>0&&te.setValue(B,"sunShadowMap",pn.state.sunShadowMap,kt),pn.state.directionalShadowMap.length>0&&te.setValue(B,"directionalShadowMap",pn.state.directionalShadowMap,kt),pn.state.spotShadowMap.length>0&&te.setValue(B,"spotShadowMap",pn.state.spotShadowMap,kt),pn.state.pointShadowMap.length>0&&te.setValue(B,"pointShadowMap",pn.state.pointShadowMap,kt)),H.isSkinnedMesh){te.setOptional(B,H,"bindMatrix"),te.setOptional(B,H,"bindMatrixInverse");let Ae=H.skeleton;Ae&&(Ae.boneTexture===null&&Ae.computeBoneTexture(),te.setValue(B,"boneTexture",Ae.boneTexture,kt))}H.isBatchedMesh&&(te.setOptional(B,H,"batchingTexture"),te.setValue(B,"batchingTexture",H._matricesTexture,kt),te.setOptional(B,H,"batchingIdTexture"),te.setValue(B,"batchingIdTexture",H._indirectTexture,kt),te.setOptional(B,H,"batchingColorTexture"),H._colorsTexture!==null&&te.setValue(B,"batchingColorTexture",H._colorsTexture,kt));let Qn=$.morphAttributes;if((Qn.position!==void 0||Qn.normal!==void 0||Qn.color!==void 0)&&K.update(H,$,ln),(Yi||wt.receiveShadow!==H.receiveShadow)&&(wt.receiveShadow=H.receiveShadow,te.setValue(B,"receiveShadow",H.receiveShadow)),(V.isMeshStandardMaterial||V.isMeshLambertMaterial||V.isMeshPhongMaterial)&&V.envMap===null&&O.environment!==null&&(Ke.envMapIntensity.value=O.environmentIntensity),Ke.dfgLUT!==void 0&&(Ke.dfgLUT.value=TS()),Yi){if(te.setValue(B,"toneMappingExposure",R.toneMappingExposure),wt.needsLights&&P0(Ke,Ms),ft&&V.fog===!0&&ot.refreshFogUniforms(Ke,ft),ot.refreshMaterialUniforms(Ke,V,mt,Ct,A.state.transmissionRenderTarget[T.id]),wt.needsLights&&wt.numLightProbeGrids>0){let Ae=v,Xe=0;for(let Mi of A.state.lightProbeGridArray)Mi.texture!==null&&(Ae.textures[Xe]=Mi.texture,Ae.min[Xe]=Mi.boundingBox.min,Ae.max[Xe]=Mi.boundingBox.max,Ae.resolution[Xe]=Mi.resolution,Xe++);for(let Mi in Ae)Ae[Mi].length=Xe;Ke.probesSH.value=Ae.textures,Ke.probesMin.value=Ae.min,Ke.probesMax.value=Ae.max,Ke.probesResolution.value=Ae.resolution}Er.upload(B,hf(wt),Ke,kt)}if(V.isShaderMaterial&&V.uniformsNeedUpdate===!0&&(Er.upload(B,hf(wt),Ke,kt),V.uniformsNeedUpdate=!1),V.isSpriteMaterial&&te.setValue(B,"center",H.center),te.setValue(B,"modelViewMatrix",H.modelViewMatrix),te.setValue(B,"normalMatrix",H.normalMatrix),te.setValue(B,"modelMatrix",H.matrixWorld),V.uniformsGroups!==void 0){let Ae=V.uniformsGroups;for(let Xe=0,Mi=Ae.length;Xe<Mi;Xe++){let ff=Ae[Xe];Et.update(ff,ln),Et.bind(ff,ln)}}return ln}function P0(T,O){T.ambientLightColor.needsUpdate=O,T.lightProbe.needsUpdate=O,T.sunLights.needsUpdate=O,T.sunLightShadows.needsUpdate=O,T.directionalLights.needsUpdate=O,T.directionalLightShadows.needsUpdate=O,T.pointLights.needsUpdate=O,T.pointLightShadows.needsUpdate=O,T.spotLights.needsUpdate=O,T.spotLightShadows.needsUpdate=O,T.rectAreaLights.needsUpdate=O,T.hemisphereLights.needsUpdate=O}function I0(T){return T.isMeshLambertMaterial||T.isMeshToonMaterial||T.isMeshPhongMaterial||T.isMeshStandardMaterial||T.isShadowMaterial||T.isShaderMaterial&&T.lights===!0}this.getActiveCubeFace=function(){return z},this.getActiveMipmapLevel=function(){return W},this.getRenderTarget=function(){return et},this.setRenderTargetTextures=function(T,O,$){let V=Dt.get(T);V.__autoAllocateDepthBuffer=T.resolveDepthBuffer===!1,V.__autoAllocateDepthBuffer===!1&&(V.__useRenderToTexture=!1),Dt.get(T.texture).__webglTexture=O,Dt.get(T.depthTexture).__webglTexture=V.__autoAllocateDepthBuffer?void 0:$,V.__hasExternalTextures=!0},this.setRenderTargetFramebuffer=function(T,O){let $=Dt.get(T);$.__webglFramebuffer=O,$.__useDefaultFramebuffer=O===void 0},this.setRenderTarget=function(T,O=0,$=0){et=T,z=O,W=$;let V=null,H=!1,ft=!1;if(T){let ht=Dt.get(T);if(ht.__useDefaultFramebuffer!==void 0){pt.bindFramebuffer(B.FRAMEBUFFER,ht.__webglFramebuffer),tt.copy(T.viewport),vt.copy(T.scissor),Ft=T.scissorTest,pt.viewport(tt),pt.scissor(vt),pt.setScissorTest(Ft),X=-1;return}else if(ht.__webglFramebuffer===void 0)kt.setupRenderTarget(T);else if(ht.__hasExternalTextures)kt.rebindTextures(T,Dt.get(T.texture).__webglTexture,Dt.get(T.depthTexture).__webglTexture);else if(T.depthBuffer){let zt=T.depthTexture;if(ht.__boundDepthTexture!==zt){if(zt!==null&&Dt.has(zt)&&(T.width!==zt.image.width||T.height!==zt.image.height))throw new Error("THREE.WebGLRenderer: Attached DepthTexture is initialized to the incorrect size.");kt.setupDepthRenderbuffer(T)}}let yt=T.texture;(yt.isData3DTexture||yt.isDataArrayTexture||yt.isCompressedArrayTexture)&&(ft=!0);let At=Dt.get(T).__webglFramebuffer;T.isWebGLCubeRenderTarget?(Array.isArray(At[O])?V=At[O][$]:V=At[O],H=!0):T.samples>0&&kt.useMultisampledRTT(T)===!1?V=Dt.get(T).__webglMultisampledFramebuffer:Array.isArray(At)?V=At[$]:V=At,tt.copy(T.viewport),vt.copy(T.scissor),Ft=T.scissorTest}else tt.copy(Lt).multiplyScalar(mt).floor(),vt.copy(Qt).multiplyScalar(mt).floor(),Ft=he;if($!==0&&(V=U),pt.bindFramebuffer(B.FRAMEBUFFER,V)&&pt.drawBuffers(T,V),pt.viewport(tt),pt.scissor(vt),pt.setScissorTest(Ft),H){let ht=Dt.get(T.texture);B.framebufferTexture2D(B.FRAMEBUFFER,B.COLOR_ATTACHMENT0,B.TEXTURE_CUBE_MAP_POSITIVE_X+O,ht.__webglTexture,$)}else if(ft){let ht=O;for(let yt=0;yt<T.textures.length;yt++){let At=Dt.get(T.textures[yt]);B.framebufferTextureLayer(B.FRAMEBUFFER,B.COLOR_ATTACHMENT0+yt,At.__webglTexture,$,ht)}}else if(T!==null&&$!==0){let ht=Dt.get(T.texture);B.framebufferTexture2D(B.FRAMEBUFFER,B.COLOR_ATTACHMENT0,B.TEXTURE_2D,ht.__webglTexture,$)}X=-1};function df(T){let O=Dt.get(T);return(O.__readFormat!==T.format||O.__readType!==T.type)&&(O.__readFormat=T.format,O.__readType=T.type,O.__formatReadable=be.textureFormatReadable(T.format),O.__typeReadable=be.textureTypeReadable(T.type)),O}this.readRenderTargetPixels=function(T,O,$,V,H,ft,bt,ht=0){if(!(T&&T.isWebGLRenderTarget)){Nt("WebGLRenderer.readRenderTargetPixels: renderTarget is not THREE.WebGLRenderTarget.");return}let yt=Dt.get(T).__webglFramebuffer;if(T.isWebGLCubeRenderTarget&&bt!==void 0&&(yt=yt[bt],Array.isArray(yt)&&(yt=yt[0])),yt){pt.bindFramebuffer(B.FRAMEBUFFER,yt);try{let At=T.textures[ht],zt=At.format,Yt=At.type;T.textures.length>1&&B.readBuffer(B.COLOR_ATTACHMENT0+ht);let Mt=df(At);if(Mt.__formatReadable===!1){Nt("WebGLRenderer.readRenderTargetPixels: renderTarget is not in RGBA or implementation defined format.");return}if(Mt.__typeReadable===!1){Nt("WebGLRenderer.readRenderTargetPixels: renderTarget is not in UnsignedByteType or implementation defined type.");return}O>=0&&O<=T.width-V&&$>=0&&$<=T.height-H&&B.readPixels(O,$,V,H,rt.convert(zt),rt.convert(Yt),ft)}finally{let At=et!==null?Dt.get(et).__webglFramebuffer:null;pt.bindFramebuffer(B.FRAMEBUFFER,At)}}},this.readRenderTargetPixelsAsync=async function(T,O,$,V,H,ft,bt,ht=0){if(!(T&&T.isWebGLRenderTarget))throw new Error("THREE.WebGLRenderer.readRenderTargetPixels: renderTarget is not THREE.WebGLRenderTarget.");let yt=Dt.get(T).__webglFramebuffer;if(T.isWebGLCubeRenderTarget&&bt!==void 0&&(yt=yt[bt],Array.isArray(yt)&&(yt=yt[0])),yt)if(O>=0&&O<=T.width-V&&$>=0&&$<=T.height-H){pt.bindFramebuffer(B.FRAMEBUFFER,yt);let At=T.textures[ht],zt=At.format,Yt=At.type;T.textures.length>1&&B.readBuffer(B.COLOR_ATTACHMENT0+ht);let Mt=df(At);if(Mt.__formatReadable===!1)throw new Error("THREE.WebGLRenderer.readRenderTargetPixelsAsync: renderTarget is not in RGBA or implementation defined format.");if(Mt.__typeReadable===!1)throw new Error("THREE.WebGLRenderer.readRenderTargetPixelsAsync: renderTarget is not in UnsignedByteType or implementation defined type.");let Zt=B.createBuffer();B.bindBuffer(B.PIXEL_PACK_BUFFER,Zt),B.bufferData(B.PIXEL_PACK_BUFFER,ft.byteLength,B.STREAM_READ),B.readPixels(O,$,V,H,rt.convert(zt),rt.convert(Yt),0),B.bindBuffer(B.PIXEL_PACK_BUFFER,null);let De=et!==null?Dt.get(et).__webglFramebuffer:null;pt.bindFramebuffer(B.FRAMEBUFFER,De);let me=B.fenceSync(B.SYNC_GPU_COMMANDS_COMPLETE,0);return B.flush(),await fm(B,me,4),B.bindBuffer(B.PIXEL_PACK_BUFFER,Zt),B.getBufferSubData(B.PIXEL_PACK_BUFFER,0,ft),B.bindBuffer(B.PIXEL_PACK_BUFFER,null),B.deleteBuffer(Zt),B.deleteSync(me),ft}else throw new Error("THREE.WebGLRenderer.readRenderTargetPixelsAsync: requested read bounds are out of range.")},this.copyFramebufferToTexture=function(T,O=null,$=0){let V=Math.pow(2,-$),H=Math.floor(T.image.width*V),ft=Math.floor(T.image.height*V),bt=O!==null?O.x:0,ht=O!==null?O.y:0;kt.setTexture2D(T,0),B.copyTexSubImage2D(B.TEXTURE_2D,$,0,0,bt,ht,H,ft),pt.unbindTexture()},this.copyTextureToTexture=function(T,O,$=null,V=null,H=0,ft=0){let bt,ht,yt,At,zt,Yt,Mt,Zt,De,me=T.isCompressedTexture?T.mipmaps[ft]:T.image;if($!==null)bt=$.max.x-$.min.x,ht=$.max.y-$.min.y,yt=$.isBox3?$.max.z-$.min.z:1,At=$.min.x,zt=$.min.y,Yt=$.isBox3?$.min.z:0;else{let te=Math.pow(2,-H);bt=Math.floor(me.width*te),ht=Math.floor(me.height*te),T.isDataArrayTexture?yt=me.depth:T.isData3DTexture?yt=Math.floor(me.depth*te):yt=1,At=0,zt=0,Yt=0}V!==null?(Mt=V.x,Zt=V.y,De=V.z):(Mt=0,Zt=0,De=0);let ue=rt.convert(O.format),an=rt.convert(O.type),wt;O.isData3DTexture?(kt.setTexture3D(O,0),wt=B.TEXTURE_3D):O.isDataArrayTexture||O.isCompressedArrayTexture?(kt.setTexture2DArray(O,0),wt=B.TEXTURE_2D_ARRAY):(kt.setTexture2D(O,0),wt=B.TEXTURE_2D),pt.activeTexture(B.TEXTURE0),pt.pixelStorei(B.UNPACK_FLIP_Y_WEBGL,O.flipY),pt.pixelStorei(B.UNPACK_PREMULTIPLY_ALPHA_WEBGL,O.premultiplyAlpha),pt.pixelStorei(B.UNPACK_ALIGNMENT,O.unpackAlignment);let pn=pt.getParameter(B.UNPACK_ROW_LENGTH),ee=pt.getParameter(B.UNPACK_IMAGE_HEIGHT),Ss=pt.getParameter(B.UNPACK_SKIP_PIXELS),ln=pt.getParameter(B.UNPACK_SKIP_ROWS),ca=pt.getParameter(B.UNPACK_SKIP_IMAGES);pt.pixelStorei(B.UNPACK_ROW_LENGTH,me.width),pt.pixelStorei(B.UNPACK_IMAGE_HEIGHT,me.height),pt.pixelStorei(B.UNPACK_SKIP_PIXELS,At),pt.pixelStorei(B.UNPACK_SKIP_ROWS,zt),pt.pixelStorei(B.UNPACK_SKIP_IMAGES,Yt);let Yi=T.isDataArrayTexture||T.isData3DTexture,Ms=O.isDataArrayTexture||O.isData3DTexture;if(T.isDepthTexture){let te=Dt.get(T),Ke=Dt.get(O),Qn=Dt.get(te.__renderTarget),Ae=Dt.get(Ke.__renderTarget);pt.bindFramebuffer(B.READ_FRAMEBUFFER,Qn.__webglFramebuffer),pt.bindFramebuffer(B.DRAW_FRAMEBUFFER,Ae.__webglFramebuffer);for(let Xe=0;Xe<yt;Xe++)Yi&&(B.framebufferTextureLayer(B.READ_FRAMEBUFFER,B.COLOR_ATTACHMENT0,Dt.get(T).__webglTexture,H,Yt+Xe),B.framebufferTextureLayer(B.DRAW_FRAMEBUFFER,B.COLOR_ATTACHMENT0,Dt.get(O).__webglTexture,ft,De+Xe)),B.blitFramebuffer(At,zt,At+bt,zt+ht,Mt,Zt,Mt+bt,Zt+ht,B.DEPTH_BUFFER_BIT,B.NEAREST);pt.bindFramebuffer(B.READ_FRAMEBUFFER,null),pt.bindFramebuffer(B.DRAW_FRAMEBUFFER,null)}else if(H!==0||T.isRenderTargetTexture||Dt.has(T)){let te=Dt.get(T),Ke=Dt.get(O);pt.bindFramebuffer(B.READ_FRAMEBUFFER,L),pt.bindFramebuffer(B.DRAW_FRAMEBUFFER,k);for(let Qn=0;Qn<yt;Qn++)Yi?B.framebufferTextureLayer(B.READ_FRAMEBUFFER,B.COLOR_ATTACHMENT0,te.__webglTexture,H,Yt+Qn):B.framebufferTexture2D(B.READ_FRAMEBUFFER,B.COLOR_ATTACHMENT0,B.TEXTURE_2D,te.__webglTexture,H),Ms?B.framebufferTextureLayer(B.DRAW_FRAMEBUFFER,B.COLOR_ATTACHMENT0,Ke.__webglTexture,ft,De+Qn):B.framebufferTexture2D(B.DRAW_FRAMEBUFFER,B.COLOR_ATTACHMENT0,B.TEXTURE_2D,Ke.__webglTexture,ft),H!==0?B.blitFramebuffer(At,zt,At+bt,zt+ht,Mt,Zt,Mt+bt,Zt+ht,B.COLOR_BUFFER_BIT,B.NEAREST):Ms?B.copyTexSubImage3D(wt,ft,Mt,Zt,De+Qn,At,zt,bt,ht):B.copyTexSubImage2D(wt,ft,Mt,Zt,At,zt,bt,ht);pt.bindFramebuffer(B.READ_FRAMEBUFFER,null),pt.bindFramebuffer(B.DRAW_FRAMEBUFFER,null)}else Ms?T.isDataTexture||T.isData3DTexture?B.texSubImage3D(wt,ft,Mt,Zt,De,bt,ht,yt,ue,an,me.data):O.isCompressedArrayTexture?B.compressedTexSubImage3D(wt,ft,Mt,Zt,De,bt,ht,yt,ue,me.data):B.texSubImage3D(wt,ft,Mt,Zt,De,bt,ht,yt,ue,an,me):T.isDataTexture?B.texSubImage2D(B.TEXTURE_2D,ft,Mt,Zt,bt,ht,ue,an,me.data):T.isCompressedTexture?B.compressedTexSubImage2D(B.TEXTURE_2D,ft,Mt,Zt,me.width,me.height,ue,me.data):B.texSubImage2D(B.TEXTURE_2D,ft,Mt,Zt,bt,ht,ue,an,me);pt.pixelStorei(B.UNPACK_ROW_LENGTH,pn),pt.pixelStorei(B.UNPACK_IMAGE_HEIGHT,ee),pt.pixelStorei(B.UNPACK_SKIP_PIXELS,Ss),pt.pixelStorei(B.UNPACK_SKIP_ROWS,ln),pt.pixelStorei(B.UNPACK_SKIP_IMAGES,ca),ft===0&&O.generateMipmaps===!0&&O.mipmapsAutoUpdate===!0&&B.generateMipmap(wt),pt.unbindTexture()},this.initRenderTarget=function(T){Dt.get(T).__webglFramebuffer===void 0&&kt.setupRenderTarget(T)},this.initTexture=function(T){T.isCubeTexture?kt.setTextureCube(T,0):T.isData3DTexture?kt.setTexture3D(T,0):T.isDataArrayTexture||T.isCompressedArrayTexture?kt.setTexture2DArray(T,0):kt.setTexture2D(T,0),pt.unbindTexture()},this.resetState=function(){z=0,W=0,et=null,pt.reset(),at.reset()},typeof __THREE_DEVTOOLS__<"u"&&__THREE_DEVTOOLS__.dispatchEvent(new CustomEvent("observe",{detail:this}))}get coordinateSystem(){return Jn}get outputColorSpace(){return this._outputColorSpace}set outputColorSpace(t){this._outputColorSpace=t;let e=this.getContext();e.drawingBufferColorSpace=Jt._getDrawingBufferColorSpace(t),e.unpackColorSpace=Jt._getUnpackColorSpace()}};var Wo=(i,t)=>[i[0]-t[0],i[1]-t[1],i[2]-t[2]],ad=(i,t)=>i[0]*t[0]+i[1]*t[1]+i[2]*t[2],Km=(i,t)=>[i[1]*t[2]-i[2]*t[1],i[2]*t[0]-i[0]*t[2],i[0]*t[1]-i[1]*t[0]],jm=i=>{let t=Math.hypot(...i)||1;return[i[0]/t,i[1]/t,i[2]/t]};function Qm(i,t,e,n){let s=[];for(let r=0;r<t.length;r+=3){let o=[0,1,2].map(A=>t[r+A]),[a,l,c]=o.map(A=>[i[3*A],i[3*A+1],i[3*A+2]]),h=jm(Wo(l,a)),u=jm(Km(Km(Wo(l,a),Wo(c,a)),h)),[d,f,p]=[[],[],[]];for(let A of o){let[x,w,D,R,N,P]=Array.from({length:6},(z,W)=>e[9*A+W]),U=z=>[x*z[0]+R*z[1]+P*z[2],R*z[0]+w*z[1]+N*z[2],P*z[0]+N*z[1]+D*z[2]],[L,k]=[ad(h,U(h)),ad(u,U(u))];d.push((L-k)/2),f.push(ad(h,U(u))),p.push((L+k)/2)}let _=(A,x)=>d[A]*f[x]-d[x]*f[A],m=[_(1,2),_(2,0),_(0,1)],g=m[0]+m[1]+m[2],y=Math.max(...d.map(Math.abs),...f.map(Math.abs),...p.map(Math.abs));if(Math.abs(g)<1e-6*y*y)continue;let b=m.map(A=>A/g);if(Math.min(...b)<-1e-6||Math.abs(b.reduce((A,x,w)=>A+x*p[w],0))<.04*n)continue;let v=[0,1,2].map(A=>b[0]*a[A]+b[1]*l[A]+b[2]*c[A]),M=1e-4*Math.hypot(...Wo(l,a));s.some(A=>Math.hypot(...Wo(A.at,v))<M)||s.push({at:v,isWedge:g>0})}return s}var Rr=Math.pow(2,-24),$o=Symbol("SKIP_GENERATION"),Dc={strategy:0,maxDepth:40,targetLeafSize:10,useSharedArrayBuffer:!1,setBoundingBox:!0,onProgress:null,indirect:!1,verbose:!0,range:null,[$o]:!1};function fe(i,t,e){return e.min.x=t[i],e.min.y=t[i+1],e.min.z=t[i+2],e.max.x=t[i+3],e.max.y=t[i+4],e.max.z=t[i+5],e}function Xo(i){let t=-1,e=-1/0;for(let n=0;n<3;n++){let s=i[n+3]-i[n];s>e&&(e=s,t=n)}return t}function ld(i,t,e){for(let n=0;n<3;n++){let s=t[i+2*n],r=t[i+2*n+1],o=s-r,a=s+r;o<e[n]&&(e[n]=o),a>e[n+3]&&(e[n+3]=a)}}function Nc(i){let t=i[3]-i[0],e=i[4]-i[1],n=i[5]-i[2];return 2*(t*e+e*n+n*t)}function jt(i,t){return t[i+15]===65535}function ae(i,t){return t[i+6]}function ce(i,t){return t[i+14]}function ne(i){return i+8}function ie(i,t){let e=t[i+6];return i+e*8}function Cr(i,t){return t[i+7]}function Fc(i,t,e,n,s){let r=1/0,o=1/0,a=1/0,l=-1/0,c=-1/0,h=-1/0,u=1/0,d=1/0,f=1/0,p=-1/0,_=-1/0,m=-1/0,g=i.offset||0;for(let y=(t-g)*6,b=(t+e-g)*6;y<b;y+=6){let v=i[y+0],M=i[y+1],A=v-M,x=v+M;A<r&&(r=A),x>l&&(l=x),v<u&&(u=v),v>p&&(p=v);let w=i[y+2],D=i[y+3],R=w-D,N=w+D;R<o&&(o=R),N>c&&(c=N),w<d&&(d=w),w>_&&(_=w);let P=i[y+4],U=i[y+5],L=P-U,k=P+U;L<a&&(a=L),k>h&&(h=k),P<f&&(f=P),P>m&&(m=P)}n[0]=r,n[1]=o,n[2]=a,n[3]=l,n[4]=c,n[5]=h,s[0]=u,s[1]=d,s[2]=f,s[3]=p,s[4]=_,s[5]=m}var bi=8,hd=8,cd=new Int32Array(bi),vi=new Float32Array(bi*6),Pr=new Float32Array(bi*6),ci=new Float32Array(6),Uc=new Float32Array(6),ps=new Int32Array(hd),eg=new Float32Array(hd*6);function PS(i,t,e,n){for(let s=0;s<3;s++){let r=t[i+2*s],o=t[i+2*s+1],a=r-o,l=r+o;a<e[n+s]&&(e[n+s]=a),l>e[n+s+3]&&(e[n+s+3]=l)}}function ng(i,t){let e=i[t+3]-i[t],n=i[t+4]-i[t+1],s=i[t+5]-i[t+2];return 2*(e*n+n*s+s*e)}function ig(i,t,e,n,s,r){let o=-1,a=0;if(r===0)o=Xo(t),o!==-1&&(a=(t[o]+t[o+3])/2);else if(r===1)o=Xo(i),o!==-1&&(a=IS(e,n,s,o));else if(r===2){let l=Nc(i),c=1.25*s,h=e.offset||0,u=(n-h)*6,d=(n+s-h)*6;for(let f=0;f<3;f++){let p=t[f],g=(t[f+3]-p)/bi;if(s<hd){for(let y=0;y<s;y++){let b=u+y*6,v=e[b+2*f],M=y;for(;M>0&&e[ps[M-1]+2*f]>v;)ps[M]=ps[M-1],M--;ps[M]=b}for(let y=0;y<3;y++)ci[y]=1/0,ci[y+3]=-1/0,Uc[y]=1/0,Uc[y+3]=-1/0;for(let y=s-1;y>=0;y--)ld(ps[y],e,Uc),eg.set(Uc,y*6);for(let y=0;y<s-1;y++){ld(ps[y],e,ci);let b=e[ps[y+1]+2*f];if(e[ps[y]+2*f]===b)continue;let v=y+1,M=s-v,A=Nc(ci)/l,x=ng(eg,v*6)/l,w=1+1.25*(A*v+x*M);w<c&&(o=f,c=w,a=b)}}else{for(let v=0;v<bi;v++){cd[v]=0;for(let M=0;M<3;M++)vi[v*6+M]=1/0,vi[v*6+M+3]=-1/0}for(let v=u;v<d;v+=6){let x=~~((e[v+2*f]-p)/g);x>=bi&&(x=bi-1),cd[x]++,PS(v,e,vi,x*6)}let y=(bi-1)*6;for(let v=0;v<6;v++)Pr[y+v]=vi[y+v];for(let v=bi-2;v>=0;v--){let M=v*6,A=M+6;for(let x=0;x<3;x++)Pr[M+x]=Math.min(vi[M+x],Pr[A+x]),Pr[M+x+3]=Math.max(vi[M+x+3],Pr[A+x+3])}let b=0;for(let v=0;v<bi-1;v++){let M=v*6,A=cd[v];if(A!==0)for(let N=0;N<3;N++)b===0?(ci[N]=vi[M+N],ci[N+3]=vi[M+N+3]):(ci[N]=Math.min(ci[N],vi[M+N]),ci[N+3]=Math.max(ci[N+3],vi[M+N+3]));b+=A;let x=0,w=0;b!==0&&(x=Nc(ci)/l);let D=s-b;D!==0&&(w=ng(Pr,M+6)/l);let R=1+1.25*(x*b+w*D);R<c&&(o=f,c=R,a=p+g+v*g)}}}}else console.warn(`BVH: Invalid build strategy value ${r} used.`);return{axis:o,pos:a}}function IS(i,t,e,n){let s=0,r=i.offset;for(let o=t,a=t+e;o<a;o++)s+=i[(o-r)*6+n*2];return s/e}function sg(i,t,e,n,s,r){let o=n,a=n+s-1,l=r.pos,c=r.axis*2,h=e.offset||0;for(;;){for(;o<=a&&e[(o-h)*6+c]<l;)o++;for(;o<=a&&e[(a-h)*6+c]>=l;)a--;if(o<a){for(let u=0;u<t;u++){let d=i[o*t+u];i[o*t+u]=i[a*t+u],i[a*t+u]=d}for(let u=0;u<6;u++){let d=o-h,f=a-h,p=e[d*6+u];e[d*6+u]=e[f*6+u],e[f*6+u]=p}o++,a--}else return o}}var LS=Math.pow(2,32),Ir=new Float32Array(6),Oc=new Float32Array(6);function DS(i,t,e,n,s,r){let{maxDepth:o,verbose:a,targetLeafSize:l,_strictLeafSize:c=1/0,strategy:h,onProgress:u,useSharedArrayBuffer:d=!1}=s,f=i.primitiveBuffer,p=i.primitiveBufferStride,_=d?SharedArrayBuffer:ArrayBuffer,m=new _(32*Math.max(1,2*Math.ceil(n)-1)),g=new Float32Array(m),y=new Uint32Array(m),b=new Uint16Array(m),v=0,M=!1;return Fc(t,e,n,Ir,Oc),w(e,n,0),m.slice(0,v*32);function A(D){u&&u((D-r.offset)/r.count)}function x(D,R,N){let P=D*2;y[D+6]=R,b[P+14]=N,b[P+15]=65535,A(R+N)}function w(D,R,N){let P=v++,U=P*8;g.set(Ir,U),!M&&N>=o&&(M=!0,a&&console.warn(`BVH: Max depth of ${o} reached when generating BVH. Consider increasing maxDepth.`));let L=R>c;if(R<=l&&!L||N>=o){x(U,D,R);return}let k=ig(Ir,Oc,t,D,R,h),z=k.axis===-1?-1:sg(f,p,t,D,R,k);if(k.axis===-1||z===D||z===D+R){if(!L){x(U,D,R);return}k.axis=Math.max(0,Xo(Ir)),z=D+Math.max(1,Math.floor(R/2))}y[U+7]=k.axis;let W=z-D;Fc(t,D,W,Ir,Oc),w(D,W,N+1);let et=v-P;if(et>LS)throw new Error("MeshBVH: Cannot store relative child node offset greater than 32 bits.");y[U+6]=et;let X=R-W;Fc(t,z,X,Ir,Oc),w(z,X,N+1)}}function rg(i,t){let e=i.getRootRanges(t.range),n=e[0],s=e[e.length-1],r={offset:n.offset,count:s.offset+s.count-n.offset},o=new Float32Array(6*r.count);o.offset=r.offset,i.computePrimitiveBounds(r.offset,r.count,o),i._roots=e.map(a=>DS(i,o,a.offset,a.count,t,r))}var ms=class{constructor(t){this._getNewPrimitive=t,this._primitives=[]}getPrimitive(){let t=this._primitives;return t.length===0?this._getNewPrimitive():t.pop()}releasePrimitive(t){this._primitives.push(t)}};var ud=class{constructor(){this.float32Array=null,this.uint16Array=null,this.uint32Array=null;let t=[],e=null;this.setBuffer=n=>{e&&t.push(e),e=n,this.float32Array=new Float32Array(n),this.uint16Array=new Uint16Array(n),this.uint32Array=new Uint32Array(n)},this.clearBuffer=()=>{e=null,this.float32Array=null,this.uint16Array=null,this.uint32Array=null,t.length!==0&&this.setBuffer(t.pop())}}},Xt=new ud;var gs,Dr,Lr=[],Bc=new ms(()=>new Se);function og(i,t,e,n,s,r){gs=Bc.getPrimitive(),Dr=Bc.getPrimitive(),Lr.push(gs,Dr),Xt.setBuffer(i._roots[t]);let o=dd(0,i.geometry,e,n,s,r);Xt.clearBuffer(),Bc.releasePrimitive(gs),Bc.releasePrimitive(Dr),Lr.pop(),Lr.pop();let a=Lr.length;return a>0&&(Dr=Lr[a-1],gs=Lr[a-2]),o}function dd(i,t,e,n,s=null,r=0,o=0){let{float32Array:a,uint16Array:l,uint32Array:c}=Xt,h=i*2;if(jt(h,l)){let d=ae(i,c),f=ce(h,l);return fe(i,a,gs),n(d,f,!1,o,r+i/8,gs)}else{let R=function(P){let{uint16Array:U,uint32Array:L}=Xt,k=P*2;for(;!jt(k,U);)P=ne(P),k=P*2;return ae(P,L)},N=function(P){let{uint16Array:U,uint32Array:L}=Xt,k=P*2;for(;!jt(k,U);)P=ie(P,L),k=P*2;return ae(P,L)+ce(k,U)},d=ne(i),f=ie(i,c),p=d,_=f,m,g,y,b;if(s&&(y=gs,b=Dr,fe(p,a,y),fe(_,a,b),m=s(y),g=s(b),g<m)){p=f,_=d;let P=m;m=g,g=P,y=b}y||(y=gs,fe(p,a,y));let v=jt(p*2,l),M=e(y,v,m,o+1,r+p/8),A;if(M===2){let P=R(p),L=N(p)-P;A=n(P,L,!0,o+1,r+p/8,y)}else A=M&&dd(p,t,e,n,s,r,o+1);if(A)return!0;b=Dr,fe(_,a,b);let x=jt(_*2,l),w=e(b,x,g,o+1,r+_/8),D;if(w===2){let P=R(_),L=N(_)-P;D=n(P,L,!0,o+1,r+_/8,b)}else D=w&&dd(_,t,e,n,s,r,o+1);return!!D}}var qo=new Xt.constructor,kc=new Xt.constructor,_s=new ms(()=>new Se),Nr=new Se,Fr=new Se,pd=new Se,md=new Se,gd=!1;function ag(i,t,e,n){if(gd)throw new Error("MeshBVH: Recursive calls to bvhcast not supported.");gd=!0;let s=i._roots,r=t._roots,o,a=0,l=0,c=new Pt().copy(e).invert();for(let h=0,u=s.length;h<u;h++){qo.setBuffer(s[h]),l=0;let d=_s.getPrimitive();fe(0,qo.float32Array,d),d.applyMatrix4(c);for(let f=0,p=r.length;f<p&&(kc.setBuffer(r[f]),o=hi(0,0,e,c,n,a,l,0,0,d),kc.clearBuffer(),l+=r[f].byteLength/32,!o);f++);if(_s.releasePrimitive(d),qo.clearBuffer(),a+=s[h].byteLength/32,o)break}return gd=!1,o}function hi(i,t,e,n,s,r=0,o=0,a=0,l=0,c=null,h=!1){let u,d;h?(u=kc,d=qo):(u=qo,d=kc);let f=u.float32Array,p=u.uint32Array,_=u.uint16Array,m=d.float32Array,g=d.uint32Array,y=d.uint16Array,b=i*2,v=t*2,M=jt(b,_),A=jt(v,y),x=!1;if(A&&M)h?x=s(ae(t,g),ce(t*2,y),ae(i,p),ce(i*2,_),l,o+t/8,a,r+i/8):x=s(ae(i,p),ce(i*2,_),ae(t,g),ce(t*2,y),a,r+i/8,l,o+t/8);else if(A){let w=_s.getPrimitive();fe(t,m,w),w.applyMatrix4(e);let D=ne(i),R=ie(i,p);fe(D,f,Nr),fe(R,f,Fr);let N=w.intersectsBox(Nr),P=w.intersectsBox(Fr);x=N&&hi(t,D,n,e,s,o,r,l,a+1,w,!h)||P&&hi(t,R,n,e,s,o,r,l,a+1,w,!h),_s.releasePrimitive(w)}else{let w=ne(t),D=ie(t,g);fe(w,m,pd),fe(D,m,md);let R=c.intersectsBox(pd),N=c.intersectsBox(md);if(R&&N)x=hi(i,w,e,n,s,r,o,a,l+1,c,h)||hi(i,D,e,n,s,r,o,a,l+1,c,h);else if(R)if(M)x=hi(i,w,e,n,s,r,o,a,l+1,c,h);else{let P=_s.getPrimitive();P.copy(pd).applyMatrix4(e);let U=ne(i),L=ie(i,p);fe(U,f,Nr),fe(L,f,Fr);let k=P.intersectsBox(Nr),z=P.intersectsBox(Fr);x=k&&hi(w,U,n,e,s,o,r,l,a+1,P,!h)||z&&hi(w,L,n,e,s,o,r,l,a+1,P,!h),_s.releasePrimitive(P)}else if(N)if(M)x=hi(i,D,e,n,s,r,o,a,l+1,c,h);else{let P=_s.getPrimitive();P.copy(md).applyMatrix4(e);let U=ne(i),L=ie(i,p);fe(U,f,Nr),fe(L,f,Fr);let k=P.intersectsBox(Nr),z=P.intersectsBox(Fr);x=k&&hi(D,U,n,e,s,o,r,l,a+1,P,!h)||z&&hi(D,L,n,e,s,o,r,l,a+1,P,!h),_s.releasePrimitive(P)}}return x}var zc=new class{constructor(){let i=null,t=null,e=null,n=!1;this.root=null,this.buffer=null,this.uint32Array=null,this.uint16Array=null,this.setBVH=(r,o)=>{if(n)throw new Error("BVHTraversalHelper: cannot call setBVH during an active traversal.");this.root=o,this.buffer=i=r._roots[o],this.uint16Array=e=new Uint16Array(i),this.uint32Array=t=new Uint32Array(i)},this.reset=()=>{this.root=null,this.buffer=i=null,this.uint16Array=e=null,this.uint32Array=t=null},this.getRangeStart=r=>{let o=r*2;for(;!jt(o,e);)r=ne(r),o=r*2;return ae(r,t)},this.getRangeEnd=r=>{let o=r*2;for(;!jt(o,e);)r=ie(r,t),o=r*2;return ae(r,t)+ce(o,e)};let s=(r,o,a)=>{let l=o*2,c=jt(l,e);if(!r(a,c,o)&&!c){let u=ne(o),d=ie(o,t);s(r,u,a+1),s(r,d,a+1)}};this.traverseBuffer=r=>{if(n)throw new Error("BVHTraversalHelper: cannot start a traversal during an active traversal.");n=!0;try{s(r,0,0)}finally{n=!1}},this.traverse=r=>{this.traverseBuffer((o,a,l)=>{if(a){let c=l*2,h=t[l+6],u=e[c+14];return r(o,a,new Float32Array(i,l*4,6),h,u)}else{let c=Cr(l,t);return r(o,a,new Float32Array(i,l*4,6),c)}})}}};var lg=new Se,Ur=new Float32Array(6),Vc=class{constructor(){this._roots=null,this.primitiveBuffer=null,this.primitiveBufferStride=null}init(t){t={...Dc,...t},"maxLeafSize"in t&&(console.warn('BVH: "maxLeafSize" option has been deprecated. Use "targetLeafSize", instead.'),t={...t,targetLeafSize:t.maxLeafSize}),rg(this,t)}getRootRanges(){throw new Error("BVH: getRootRanges() not implemented")}writePrimitiveBounds(){throw new Error("BVH: writePrimitiveBounds() not implemented")}writePrimitiveRangeBounds(t,e,n,s){let r=1/0,o=1/0,a=1/0,l=-1/0,c=-1/0,h=-1/0;for(let u=t,d=t+e;u<d;u++){this.writePrimitiveBounds(u,Ur,0);let[f,p,_,m,g,y]=Ur;f<r&&(r=f),m>l&&(l=m),p<o&&(o=p),g>c&&(c=g),_<a&&(a=_),y>h&&(h=y)}return n[s+0]=r,n[s+1]=o,n[s+2]=a,n[s+3]=l,n[s+4]=c,n[s+5]=h,n}computePrimitiveBounds(t,e,n){let s=n.offset||0;for(let r=t,o=t+e;r<o;r++){this.writePrimitiveBounds(r,Ur,0);let[a,l,c,h,u,d]=Ur,f=(a+h)/2,p=(l+u)/2,_=(c+d)/2,m=(h-a)/2,g=(u-l)/2,y=(d-c)/2,b=(r-s)*6;n[b+0]=f,n[b+1]=m+(Math.abs(f)+m)*Rr,n[b+2]=p,n[b+3]=g+(Math.abs(p)+g)*Rr,n[b+4]=_,n[b+5]=y+(Math.abs(_)+y)*Rr}return n}shiftPrimitiveOffsets(t){let e=this._indirectBuffer;if(e)for(let n=0,s=e.length;n<s;n++)e[n]+=t;else{let n=this._roots;for(let s=0;s<n.length;s++){let r=n[s],o=new Uint32Array(r),a=new Uint16Array(r),l=r.byteLength/32;for(let c=0;c<l;c++){let h=8*c,u=2*h;jt(u,a)&&(o[h+6]+=t)}}}}traverse(t,e=0){zc.setBVH(this,e),zc.traverse(t),zc.reset()}refit(){let t=this._roots;for(let e=0,n=t.length;e<n;e++){let s=t[e],r=new Uint32Array(s),o=new Uint16Array(s),a=new Float32Array(s),l=s.byteLength/32;for(let c=l-1;c>=0;c--){let h=c*8,u=h*2;if(jt(u,o)){let f=ae(h,r),p=ce(u,o);this.writePrimitiveRangeBounds(f,p,Ur,0),a.set(Ur,h)}else{let f=ne(h),p=ie(h,r);for(let _=0;_<3;_++){let m=a[f+_],g=a[f+_+3],y=a[p+_],b=a[p+_+3];a[h+_]=m<y?m:y,a[h+_+3]=g>b?g:b}}}}}getBoundingBox(t){return t.makeEmpty(),this._roots.forEach(n=>{fe(0,new Float32Array(n),lg),t.union(lg)}),t}shapecast(t){let{boundsTraverseOrder:e,intersectsBounds:n,intersectsRange:s,intersectsPrimitive:r,scratchPrimitive:o,iterate:a}=t;if(s&&r){let u=s;s=(d,f,p,_,m)=>u(d,f,p,_,m)?!0:a(d,f,this,r,p,_,o)}else s||(r?s=(u,d,f,p)=>a(u,d,this,r,f,p,o):s=(u,d,f)=>f);let l=!1,c=0,h=this._roots;for(let u=0,d=h.length;u<d;u++){let f=h[u];if(l=og(this,u,n,s,e,c),l)break;c+=f.byteLength/32}return l}bvhcast(t,e,n){let{intersectsRanges:s}=n;return ag(this,t,e,s)}};function cg(){return typeof SharedArrayBuffer<"u"}function _d(i){return i.index?i.index.count:i.attributes.position.count}function ys(i){return _d(i)/3}function FS(i,t=ArrayBuffer){return i>65535?new Uint32Array(new t(4*i)):new Uint16Array(new t(2*i))}function hg(i,t){if(!i.index){let e=i.attributes.position.count,n=t.useSharedArrayBuffer?SharedArrayBuffer:ArrayBuffer,s=FS(e,n);i.setIndex(new Ht(s,1));for(let r=0;r<e;r++)s[r]=r}}function US(i,t,e){let n=_d(i)/e,s=t||i.drawRange,r=s.start/e,o=(s.start+s.count)/e,a=Math.max(0,r),l=Math.min(n,o)-a;return{offset:Math.floor(a),count:Math.floor(l)}}function OS(i,t){return i.groups.map(e=>({offset:e.start/t,count:e.count/t}))}function yd(i,t,e){let n=US(i,t,e),s=OS(i,e);if(!s.length)return[n];let r=[],o=n.offset,a=n.offset+n.count,l=_d(i)/e,c=[];for(let d of s){let{offset:f,count:p}=d,_=f,m=isFinite(p)?p:l-f,g=f+m;_<a&&g>o&&(c.push({pos:Math.max(o,_),isStart:!0}),c.push({pos:Math.min(a,g),isStart:!1}))}c.sort((d,f)=>d.pos!==f.pos?d.pos-f.pos:d.type==="end"?-1:1);let h=0,u=null;for(let d of c){let f=d.pos;h!==0&&f!==u&&r.push({offset:u,count:f-u}),h+=d.isStart?1:-1,u=f}return r}function BS(i,t){let e=i[i.length-1],n=e.offset+e.count>2**16,s=i.reduce((c,h)=>c+h.count,0),r=n?4:2,o=t?new SharedArrayBuffer(s*r):new ArrayBuffer(s*r),a=n?new Uint32Array(o):new Uint16Array(o),l=0;for(let c=0;c<i.length;c++){let{offset:h,count:u}=i[c];for(let d=0;d<u;d++)a[l+d]=h+d;l+=u}return a}var Gc=class extends Vc{get indirect(){return!!this._indirectBuffer}get primitiveStride(){return null}get primitiveBufferStride(){return this.indirect?1:this.primitiveStride}set primitiveBufferStride(t){}get primitiveBuffer(){return this.indirect?this._indirectBuffer:this.geometry.index.array}set primitiveBuffer(t){}constructor(t,e={}){if(t.isBufferGeometry){if(t.index&&t.index.isInterleavedBufferAttribute)throw new Error("BVH: InterleavedBufferAttribute is not supported for the index attribute.")}else throw new Error("BVH: Only BufferGeometries are supported.");if(e.useSharedArrayBuffer&&!cg())throw new Error("BVH: SharedArrayBuffer is not available.");super(),this.geometry=t,this.resolvePrimitiveIndex=e.indirect?n=>this._indirectBuffer[n]:n=>n,this.primitiveBuffer=null,this.primitiveBufferStride=null,this._indirectBuffer=null,e={...Dc,...e},e[$o]||this.init(e)}init(t){let{geometry:e,primitiveStride:n}=this;if(t.indirect){let s=yd(e,t.range,n),r=BS(s,t.useSharedArrayBuffer);this._indirectBuffer=r}else hg(e,t);super.init(t),!e.boundingBox&&t.setBoundingBox&&(e.boundingBox=this.getBoundingBox(new Se))}getRootRanges(t){return this.indirect?[{offset:0,count:this._indirectBuffer.length}]:yd(this.geometry,t,this.primitiveStride)}raycastObject3D(){throw new Error("BVH: raycastObject3D() not implemented")}};var zn=class{constructor(){this.min=1/0,this.max=-1/0}setFromPointsField(t,e){let n=1/0,s=-1/0;for(let r=0,o=t.length;r<o;r++){let l=t[r][e];n=l<n?l:n,s=l>s?l:s}this.min=n,this.max=s}setFromPoints(t,e){let n=1/0,s=-1/0;for(let r=0,o=e.length;r<o;r++){let a=e[r],l=t.dot(a);n=l<n?l:n,s=l>s?l:s}this.min=n,this.max=s}isSeparated(t){return this.min>t.max||t.min>this.max}};zn.prototype.setFromBox=(function(){let i=new C;return function(e,n){let s=n.min,r=n.max,o=1/0,a=-1/0;for(let l=0;l<=1;l++)for(let c=0;c<=1;c++)for(let h=0;h<=1;h++){i.x=s.x*l+r.x*(1-l),i.y=s.y*c+r.y*(1-c),i.z=s.z*h+r.z*(1-h);let u=e.dot(i);o=Math.min(u,o),a=Math.max(u,a)}this.min=o,this.max=a}})();var kS=(function(){let i=new C,t=new C,e=new C;return function(s,r,o){let a=s.start,l=i,c=r.start,h=t;e.subVectors(a,c),i.subVectors(s.end,s.start),t.subVectors(r.end,r.start);let u=e.dot(h),d=h.dot(l),f=h.dot(h),p=e.dot(l),m=l.dot(l)*f-d*d,g,y;m!==0?g=(u*d-p*f)/m:g=0,y=(u+g*d)/f,o.x=g,o.y=y}})(),Yo=(function(){let i=new St,t=new C,e=new C;return function(s,r,o,a){kS(s,r,i);let l=i.x,c=i.y;if(l>=0&&l<=1&&c>=0&&c<=1){s.at(l,o),r.at(c,a);return}else if(l>=0&&l<=1){c<0?r.at(0,a):r.at(1,a),s.closestPointToPoint(a,!0,o);return}else if(c>=0&&c<=1){l<0?s.at(0,o):s.at(1,o),r.closestPointToPoint(o,!0,a);return}else{let h;l<0?h=s.start:h=s.end;let u;c<0?u=r.start:u=r.end;let d=t,f=e;if(s.closestPointToPoint(u,!0,t),r.closestPointToPoint(h,!0,e),d.distanceToSquared(u)<=f.distanceToSquared(h)){o.copy(d),a.copy(u);return}else{o.copy(h),a.copy(f);return}}}})(),ug=(function(){let i=new C,t=new C,e=new tn,n=new vn;return function(r,o){let{radius:a,center:l}=r,{a:c,b:h,c:u}=o;if(n.start=c,n.end=h,n.closestPointToPoint(l,!0,i).distanceTo(l)<=a||(n.start=c,n.end=u,n.closestPointToPoint(l,!0,i).distanceTo(l)<=a)||(n.start=h,n.end=u,n.closestPointToPoint(l,!0,i).distanceTo(l)<=a))return!0;let _=o.getPlane(e);if(Math.abs(_.distanceToPoint(l))<=a){let g=_.projectPoint(l,t);if(o.containsPoint(g))return!0}return!1}})();var zS=["x","y","z"],Wi=1e-15,dg=Wi*Wi;function Kn(i){return Math.abs(i)<Wi}var rn=class extends en{constructor(...t){super(...t),this.isExtendedTriangle=!0,this.satAxes=new Array(4).fill().map(()=>new C),this.satBounds=new Array(4).fill().map(()=>new zn),this.points=[this.a,this.b,this.c],this.plane=new tn,this.isDegenerateIntoSegment=!1,this.isDegenerateIntoPoint=!1,this.degenerateSegment=new vn,this.needsUpdate=!0}intersectsSphere(t){return ug(t,this)}update(){let t=this.a,e=this.b,n=this.c,s=this.points,r=this.satAxes,o=this.satBounds,a=r[0],l=o[0];this.getNormal(a),l.setFromPoints(a,s);let c=r[1],h=o[1];c.subVectors(t,e),h.setFromPoints(c,s);let u=r[2],d=o[2];u.subVectors(e,n),d.setFromPoints(u,s);let f=r[3],p=o[3];f.subVectors(n,t),p.setFromPoints(f,s);let _=c.length(),m=u.length(),g=f.length();this.isDegenerateIntoPoint=!1,this.isDegenerateIntoSegment=!1,_<Wi?m<Wi||g<Wi?this.isDegenerateIntoPoint=!0:(this.isDegenerateIntoSegment=!0,this.degenerateSegment.start.copy(t),this.degenerateSegment.end.copy(n)):m<Wi?g<Wi?this.isDegenerateIntoPoint=!0:(this.isDegenerateIntoSegment=!0,this.degenerateSegment.start.copy(e),this.degenerateSegment.end.copy(t)):g<Wi&&(this.isDegenerateIntoSegment=!0,this.degenerateSegment.start.copy(n),this.degenerateSegment.end.copy(e)),this.plane.setFromNormalAndCoplanarPoint(a,t),this.needsUpdate=!1}};rn.prototype.closestPointToSegment=(function(){let i=new C,t=new C,e=new vn;return function(s,r=null,o=null){this.needsUpdate&&this.update();let{start:a,end:l}=s,c=this.points,h,u=1/0,d=this.plane.distanceToPoint(a),f=this.plane.distanceToPoint(l);if(d*f<0&&this.plane.intersectLine(s,i)!==null&&this.containsPoint(i))return r&&r.copy(i),o&&o.copy(i),0;for(let p=0;p<3;p++){let _=(p+1)%3;e.start.copy(c[p]),e.end.copy(c[_]),Yo(e,s,i,t),h=i.distanceToSquared(t),h<u&&(u=h,r&&r.copy(i),o&&o.copy(t))}return this.closestPointToPoint(a,i),h=a.distanceToSquared(i),h<u&&(u=h,r&&r.copy(i),o&&o.copy(a)),this.closestPointToPoint(l,i),h=l.distanceToSquared(i),h<u&&(u=h,r&&r.copy(i),o&&o.copy(l)),Math.sqrt(u)}})();rn.prototype.intersectsTriangle=(function(){let i=new rn,t=new zn,e=new zn,n=new C,s=new C,r=new C,o=new C,a=new vn,l=new vn,c=new C,h=new St,u=new St;function d(b,v,M,A){let x=n;!b.isDegenerateIntoPoint&&!b.isDegenerateIntoSegment?x.copy(b.plane.normal):x.copy(v.plane.normal);let w=b.satBounds,D=b.satAxes;for(let P=1;P<4;P++){let U=w[P],L=D[P];if(t.setFromPoints(L,v.points),U.isSeparated(t)||(o.copy(x).cross(L),t.setFromPoints(o,b.points),e.setFromPoints(o,v.points),t.isSeparated(e)))return!1}let R=v.satBounds,N=v.satAxes;for(let P=1;P<4;P++){let U=R[P],L=N[P];if(t.setFromPoints(L,b.points),U.isSeparated(t)||(o.crossVectors(x,L),t.setFromPoints(o,b.points),e.setFromPoints(o,v.points),t.isSeparated(e)))return!1}return M&&(A||console.warn("ExtendedTriangle.intersectsTriangle: Triangles are coplanar which does not support an output edge. Setting edge to 0, 0, 0."),M.start.set(0,0,0),M.end.set(0,0,0)),!0}function f(b,v,M,A,x,w,D,R,N,P,U){let L=D/(D-R);P.x=A+(x-A)*L,U.start.subVectors(v,b).multiplyScalar(L).add(b),L=D/(D-N),P.y=A+(w-A)*L,U.end.subVectors(M,b).multiplyScalar(L).add(b)}function p(b,v,M,A,x,w,D,R,N,P,U){if(x>0)f(b.c,b.a,b.b,A,v,M,N,D,R,P,U);else if(w>0)f(b.b,b.a,b.c,M,v,A,R,D,N,P,U);else if(R*N>0||D!=0)f(b.a,b.b,b.c,v,M,A,D,R,N,P,U);else if(R!=0)f(b.b,b.a,b.c,M,v,A,R,D,N,P,U);else if(N!=0)f(b.c,b.a,b.b,A,v,M,N,D,R,P,U);else return!0;return!1}function _(b,v,M,A){let x=v.degenerateSegment,w=b.plane.distanceToPoint(x.start),D=b.plane.distanceToPoint(x.end);return Kn(w)?Kn(D)?d(b,v,M,A):(M&&(M.start.copy(x.start),M.end.copy(x.start)),b.containsPoint(x.start)):Kn(D)?(M&&(M.start.copy(x.end),M.end.copy(x.end)),b.containsPoint(x.end)):b.plane.intersectLine(x,n)!=null?(M&&(M.start.copy(n),M.end.copy(n)),b.containsPoint(n)):!1}function m(b,v,M){let A=v.a;return Kn(b.plane.distanceToPoint(A))&&b.containsPoint(A)?(M&&(M.start.copy(A),M.end.copy(A)),!0):!1}function g(b,v,M){let A=b.degenerateSegment,x=v.a;return A.closestPointToPoint(x,!0,n),x.distanceToSquared(n)<dg?(M&&(M.start.copy(x),M.end.copy(x)),!0):!1}function y(b,v,M,A){if(b.isDegenerateIntoSegment)if(v.isDegenerateIntoSegment){let x=b.degenerateSegment,w=v.degenerateSegment,D=s,R=r;x.delta(D),w.delta(R);let N=n.subVectors(w.start,x.start),P=D.x*R.y-D.y*R.x;if(Kn(P))return!1;let U=(N.x*R.y-N.y*R.x)/P,L=-(D.x*N.y-D.y*N.x)/P;if(U<0||U>1||L<0||L>1)return!1;let k=x.start.z+D.z*U,z=w.start.z+R.z*L;return Kn(k-z)?(M&&(M.start.copy(x.start).addScaledVector(D,U),M.end.copy(x.start).addScaledVector(D,U)),!0):!1}else return v.isDegenerateIntoPoint?g(b,v,M):_(v,b,M,A);else{if(b.isDegenerateIntoPoint)return v.isDegenerateIntoPoint?v.a.distanceToSquared(b.a)<dg?(M&&(M.start.copy(b.a),M.end.copy(b.a)),!0):!1:v.isDegenerateIntoSegment?g(v,b,M):m(v,b,M);if(v.isDegenerateIntoPoint)return m(b,v,M);if(v.isDegenerateIntoSegment)return _(b,v,M,A)}}return function(v,M=null,A=!1){this.needsUpdate&&this.update(),v.isExtendedTriangle?v.needsUpdate&&v.update():(i.copy(v),i.update(),v=i);let x=y(this,v,M,A);if(x!==void 0)return x;let w=this.plane,D=v.plane,R=D.distanceToPoint(this.a),N=D.distanceToPoint(this.b),P=D.distanceToPoint(this.c);Kn(R)&&(R=0),Kn(N)&&(N=0),Kn(P)&&(P=0);let U=R*N,L=R*P;if(U>0&&L>0)return!1;let k=w.distanceToPoint(v.a),z=w.distanceToPoint(v.b),W=w.distanceToPoint(v.c);Kn(k)&&(k=0),Kn(z)&&(z=0),Kn(W)&&(W=0);let et=k*z,X=k*W;if(et>0&&X>0)return!1;s.copy(w.normal),r.copy(D.normal);let Q=s.cross(r),tt=0,vt=Math.abs(Q.x),Ft=Math.abs(Q.y);Ft>vt&&(vt=Ft,tt=1),Math.abs(Q.z)>vt&&(tt=2);let ut=zS[tt],xt=this.a[ut],Ct=this.b[ut],mt=this.c[ut],Bt=v.a[ut],Ce=v.b[ut],Lt=v.c[ut];if(p(this,xt,Ct,mt,U,L,R,N,P,h,a))return d(this,v,M,A);if(p(v,Bt,Ce,Lt,et,X,k,z,W,u,l))return d(this,v,M,A);if(h.y<h.x){let Qt=h.y;h.y=h.x,h.x=Qt,c.copy(a.start),a.start.copy(a.end),a.end.copy(c)}if(u.y<u.x){let Qt=u.y;u.y=u.x,u.x=Qt,c.copy(l.start),l.start.copy(l.end),l.end.copy(c)}return h.y<u.x||u.y<h.x?!1:(M&&(u.x>h.x?M.start.copy(l.start):M.start.copy(a.start),u.y<h.y?M.end.copy(l.end):M.end.copy(a.end)),!0)}})();rn.prototype.distanceToPoint=(function(){let i=new C;return function(e){return this.closestPointToPoint(e,i),e.distanceTo(i)}})();rn.prototype.distanceToTriangle=(function(){let i=new C,t=new C,e=["a","b","c"],n=new vn,s=new vn;return function(o,a=null,l=null){let c=a||l?n:null;if(this.intersectsTriangle(o,c,!0))return(a||l)&&(a&&c.getCenter(a),l&&c.getCenter(l)),0;let h=1/0;for(let u=0;u<3;u++){let d,f=e[u],p=o[f];this.closestPointToPoint(p,i),d=p.distanceToSquared(i),d<h&&(h=d,a&&a.copy(i),l&&l.copy(p));let _=this[f];o.closestPointToPoint(_,i),d=_.distanceToSquared(i),d<h&&(h=d,a&&a.copy(_),l&&l.copy(i))}for(let u=0;u<3;u++){let d=e[u],f=e[(u+1)%3];n.set(this[d],this[f]);for(let p=0;p<3;p++){let _=e[p],m=e[(p+1)%3];s.set(o[_],o[m]),Yo(n,s,i,t);let g=i.distanceToSquared(t);g<h&&(h=g,a&&a.copy(i),l&&l.copy(t))}}return Math.sqrt(h)}})();var Pe=class{constructor(t,e,n){this.isOrientedBox=!0,this.min=new C,this.max=new C,this.matrix=new Pt,this.invMatrix=new Pt,this.points=new Array(8).fill().map(()=>new C),this.satAxes=new Array(3).fill().map(()=>new C),this.satBounds=new Array(3).fill().map(()=>new zn),this.alignedSatBounds=new Array(3).fill().map(()=>new zn),this.needsUpdate=!1,t&&this.min.copy(t),e&&this.max.copy(e),n&&this.matrix.copy(n)}set(t,e,n){this.min.copy(t),this.max.copy(e),this.matrix.copy(n),this.needsUpdate=!0}copy(t){this.min.copy(t.min),this.max.copy(t.max),this.matrix.copy(t.matrix),this.needsUpdate=!0}};Pe.prototype.update=(function(){return function(){let t=this.matrix,e=this.min,n=this.max,s=this.points;for(let c=0;c<=1;c++)for(let h=0;h<=1;h++)for(let u=0;u<=1;u++){let d=1*c|2*h|4*u,f=s[d];f.x=c?n.x:e.x,f.y=h?n.y:e.y,f.z=u?n.z:e.z,f.applyMatrix4(t)}let r=this.satBounds,o=this.satAxes,a=s[0];for(let c=0;c<3;c++){let h=o[c],u=r[c],d=1<<c,f=s[d];h.subVectors(a,f),u.setFromPoints(h,s)}let l=this.alignedSatBounds;l[0].setFromPointsField(s,"x"),l[1].setFromPointsField(s,"y"),l[2].setFromPointsField(s,"z"),this.invMatrix.copy(this.matrix).invert(),this.needsUpdate=!1}})();Pe.prototype.intersectsBox=(function(){let i=new zn;return function(e){this.needsUpdate&&this.update();let n=e.min,s=e.max,r=this.satBounds,o=this.satAxes,a=this.alignedSatBounds;if(i.min=n.x,i.max=s.x,a[0].isSeparated(i)||(i.min=n.y,i.max=s.y,a[1].isSeparated(i))||(i.min=n.z,i.max=s.z,a[2].isSeparated(i)))return!1;for(let l=0;l<3;l++){let c=o[l],h=r[l];if(i.setFromBox(c,e),h.isSeparated(i))return!1}return!0}})();Pe.prototype.intersectsTriangle=(function(){let i=new rn,t=new Array(3),e=new zn,n=new zn,s=new C;return function(o){this.needsUpdate&&this.update(),o.isExtendedTriangle?o.needsUpdate&&o.update():(i.copy(o),i.update(),o=i);let a=this.satBounds,l=this.satAxes;t[0]=o.a,t[1]=o.b,t[2]=o.c;for(let d=0;d<3;d++){let f=a[d],p=l[d];if(e.setFromPoints(p,t),f.isSeparated(e))return!1}let c=o.satBounds,h=o.satAxes,u=this.points;for(let d=0;d<3;d++){let f=c[d],p=h[d];if(e.setFromPoints(p,u),f.isSeparated(e))return!1}for(let d=0;d<3;d++){let f=l[d];for(let p=0;p<4;p++){let _=h[p];if(s.crossVectors(f,_),e.setFromPoints(s,t),n.setFromPoints(s,u),e.isSeparated(n))return!1}}return!0}})();Pe.prototype.closestPointToPoint=(function(){return function(t,e){return this.needsUpdate&&this.update(),e.copy(t).applyMatrix4(this.invMatrix).clamp(this.min,this.max).applyMatrix4(this.matrix),e}})();Pe.prototype.distanceToPoint=(function(){let i=new C;return function(e){return this.closestPointToPoint(e,i),e.distanceTo(i)}})();Pe.prototype.distanceToBox=(function(){let i=["x","y","z"],t=new Array(12).fill().map(()=>new vn),e=new Array(12).fill().map(()=>new vn),n=new C,s=new C;return function(o,a=0,l=null,c=null){if(this.needsUpdate&&this.update(),this.intersectsBox(o))return(l||c)&&(o.getCenter(s),this.closestPointToPoint(s,n),o.closestPointToPoint(n,s),l&&l.copy(n),c&&c.copy(s)),0;let h=a*a,u=o.min,d=o.max,f=this.points,p=1/0;for(let m=0;m<8;m++){let g=f[m];s.copy(g).clamp(u,d);let y=g.distanceToSquared(s);if(y<p&&(p=y,l&&l.copy(g),c&&c.copy(s),y<h))return Math.sqrt(y)}let _=0;for(let m=0;m<3;m++)for(let g=0;g<=1;g++)for(let y=0;y<=1;y++){let b=(m+1)%3,v=(m+2)%3,M=g<<b|y<<v,A=1<<m|g<<b|y<<v,x=f[M],w=f[A];t[_].set(x,w);let R=i[m],N=i[b],P=i[v],U=e[_],L=U.start,k=U.end;L[R]=u[R],L[N]=g?u[N]:d[N],L[P]=y?u[P]:d[P],k[R]=d[R],k[N]=g?u[N]:d[N],k[P]=y?u[P]:d[P],_++}for(let m=0;m<=1;m++)for(let g=0;g<=1;g++)for(let y=0;y<=1;y++){s.x=m?d.x:u.x,s.y=g?d.y:u.y,s.z=y?d.z:u.z,this.closestPointToPoint(s,n);let b=s.distanceToSquared(n);if(b<p&&(p=b,l&&l.copy(n),c&&c.copy(s),b<h))return Math.sqrt(b)}for(let m=0;m<12;m++){let g=t[m];for(let y=0;y<12;y++){let b=e[y];Yo(g,b,n,s);let v=n.distanceToSquared(s);if(v<p&&(p=v,l&&l.copy(n),c&&c.copy(s),v<h))return Math.sqrt(v)}}return Math.sqrt(p)}})();var xd=class extends ms{constructor(){super(()=>new rn)}},bn=new xd;var Zo=new C,vd=new C;function fg(i,t,e={},n=0,s=1/0){let r=n*n,o=s*s,a=1/0,l=null;if(i.shapecast({boundsTraverseOrder:h=>(Zo.copy(t).clamp(h.min,h.max),Zo.distanceToSquared(t)),intersectsBounds:(h,u,d)=>d<a&&d<o,intersectsTriangle:(h,u)=>{h.closestPointToPoint(t,Zo);let d=t.distanceToSquared(Zo);return d<a&&(vd.copy(Zo),a=d,l=u),d<r}}),a===1/0)return null;let c=Math.sqrt(a);return e.point?e.point.copy(vd):e.point=vd.clone(),e.distance=c,e.faceIndex=l,e}var Hc=parseInt("187")>=169,VS=parseInt("187")<=161,Bs=new C,ks=new C,zs=new C,Wc=new St,$c=new St,Xc=new St,pg=new C,mg=new C,gg=new C,Jo=new C;function GS(i,t,e,n,s,r,o,a){let l;if(r===nn?l=i.intersectTriangle(n,e,t,!0,s):l=i.intersectTriangle(t,e,n,r!==Te,s),l===null)return null;let c=i.origin.distanceTo(s);return c<o||c>a?null:{distance:c,point:s.clone()}}function _g(i,t,e,n,s,r,o,a,l,c,h){Bs.fromBufferAttribute(t,r),ks.fromBufferAttribute(t,o),zs.fromBufferAttribute(t,a);let u=GS(i,Bs,ks,zs,Jo,l,c,h);if(u){if(n){Wc.fromBufferAttribute(n,r),$c.fromBufferAttribute(n,o),Xc.fromBufferAttribute(n,a),u.uv=new St;let f=en.getInterpolation(Jo,Bs,ks,zs,Wc,$c,Xc,u.uv);Hc||(u.uv=f)}if(s){Wc.fromBufferAttribute(s,r),$c.fromBufferAttribute(s,o),Xc.fromBufferAttribute(s,a),u.uv1=new St;let f=en.getInterpolation(Jo,Bs,ks,zs,Wc,$c,Xc,u.uv1);Hc||(u.uv1=f),VS&&(u.uv2=u.uv1)}if(e){pg.fromBufferAttribute(e,r),mg.fromBufferAttribute(e,o),gg.fromBufferAttribute(e,a),u.normal=new C;let f=en.getInterpolation(Jo,Bs,ks,zs,pg,mg,gg,u.normal);u.normal.dot(i.direction)>0&&u.normal.multiplyScalar(-1),Hc||(u.normal=f)}let d={a:r,b:o,c:a,normal:new C,materialIndex:0};if(en.getNormal(Bs,ks,zs,d.normal),u.face=d,u.faceIndex=r,Hc){let f=new C;en.getBarycoord(Jo,Bs,ks,zs,f),u.barycoord=f}}return u}function yg(i){return i&&i.isMaterial?i.side:i}function Or(i,t,e,n,s,r,o){let a=n*3,l=a+0,c=a+1,h=a+2,{index:u,groups:d}=i;i.index&&(l=u.getX(l),c=u.getX(c),h=u.getX(h));let{position:f,normal:p,uv:_,uv1:m}=i.attributes;if(Array.isArray(t)){let g=n*3;for(let y=0,b=d.length;y<b;y++){let{start:v,count:M,materialIndex:A}=d[y];if(g>=v&&g<v+M){let x=yg(t[A]),w=_g(e,f,p,_,m,l,c,h,x,r,o);if(w)if(w.faceIndex=n,w.face.materialIndex=A,s)s.push(w);else return w}}}else{let g=yg(t),y=_g(e,f,p,_,m,l,c,h,g,r,o);if(y)if(y.faceIndex=n,y.face.materialIndex=0,s)s.push(y);else return y}return null}function pe(i,t,e,n){let s=i.a,r=i.b,o=i.c,a=t,l=t+1,c=t+2;e&&(a=e.getX(a),l=e.getX(l),c=e.getX(c)),s.x=n.getX(a),s.y=n.getY(a),s.z=n.getZ(a),r.x=n.getX(l),r.y=n.getY(l),r.z=n.getZ(l),o.x=n.getX(c),o.y=n.getY(c),o.z=n.getZ(c)}function xg(i,t,e,n,s,r,o,a){let{geometry:l,_indirectBuffer:c}=i;for(let h=n,u=n+s;h<u;h++)Or(l,t,e,h,r,o,a)}function vg(i,t,e,n,s,r,o){let{geometry:a,_indirectBuffer:l}=i,c=1/0,h=null;for(let u=n,d=n+s;u<d;u++){let f;f=Or(a,t,e,u,null,r,o),f&&f.distance<c&&(h=f,c=f.distance)}return h}function bg(i,t,e,n,s,r,o){let{geometry:a}=e,{index:l}=a,c=a.attributes.position;for(let h=i,u=t+i;h<u;h++){let d;if(d=h,pe(o,d*3,l,c),o.needsUpdate=!0,n(o,d,s,r))return!0}return!1}function Sg(i,t=null){t&&Array.isArray(t)&&(t=new Set(t));let e=i.geometry,n=e.index?e.index.array:null,s=e.attributes.position,r,o,a,l,c=0,h=i._roots;for(let d=0,f=h.length;d<f;d++)r=h[d],o=new Uint32Array(r),a=new Uint16Array(r),l=new Float32Array(r),u(0,c),c+=r.byteLength;function u(d,f,p=!1){let _=d*2;if(jt(_,a)){let m=ae(d,o),g=ce(_,a),y=1/0,b=1/0,v=1/0,M=-1/0,A=-1/0,x=-1/0;for(let w=3*m,D=3*(m+g);w<D;w++){let R=n[w],N=s.getX(R),P=s.getY(R),U=s.getZ(R);N<y&&(y=N),N>M&&(M=N),P<b&&(b=P),P>A&&(A=P),U<v&&(v=U),U>x&&(x=U)}return l[d+0]!==y||l[d+1]!==b||l[d+2]!==v||l[d+3]!==M||l[d+4]!==A||l[d+5]!==x?(l[d+0]=y,l[d+1]=b,l[d+2]=v,l[d+3]=M,l[d+4]=A,l[d+5]=x,!0):!1}else{let m=ne(d),g=ie(d,o),y=p,b=!1,v=!1;if(t){if(!y){let R=m/8+f/32,N=g/8+f/32;b=t.has(R),v=t.has(N),y=!b&&!v}}else b=!0,v=!0;let M=y||b,A=y||v,x=!1;M&&(x=u(m,f,y));let w=!1;A&&(w=u(g,f,y));let D=x||w;if(D)for(let R=0;R<3;R++){let N=m+R,P=g+R,U=l[N],L=l[N+3],k=l[P],z=l[P+3];l[d+R]=U<k?U:k,l[d+R+3]=L>z?L:z}return D}}}function fn(i,t,e,n,s){let r,o,a,l,c,h,u=1/e.direction.x,d=1/e.direction.y,f=1/e.direction.z,p=e.origin.x,_=e.origin.y,m=e.origin.z,g=t[i],y=t[i+3],b=t[i+1],v=t[i+3+1],M=t[i+2],A=t[i+3+2];return u>=0?(r=(g-p)*u,o=(y-p)*u):(r=(y-p)*u,o=(g-p)*u),d>=0?(a=(b-_)*d,l=(v-_)*d):(a=(v-_)*d,l=(b-_)*d),r>l||a>o||((a>r||isNaN(r))&&(r=a),(l<o||isNaN(o))&&(o=l),f>=0?(c=(M-m)*f,h=(A-m)*f):(c=(A-m)*f,h=(M-m)*f),r>h||c>o)?!1:((c>r||r!==r)&&(r=c),(h<o||o!==o)&&(o=h),r<=s&&o>=n)}function Mg(i,t,e,n,s,r,o,a){let{geometry:l,_indirectBuffer:c}=i;for(let h=n,u=n+s;h<u;h++){let d=c?c[h]:h;Or(l,t,e,d,r,o,a)}}function wg(i,t,e,n,s,r,o){let{geometry:a,_indirectBuffer:l}=i,c=1/0,h=null;for(let u=n,d=n+s;u<d;u++){let f;f=Or(a,t,e,l?l[u]:u,null,r,o),f&&f.distance<c&&(h=f,c=f.distance)}return h}function Ag(i,t,e,n,s,r,o){let{geometry:a}=e,{index:l}=a,c=a.attributes.position;for(let h=i,u=t+i;h<u;h++){let d;if(d=e.resolveTriangleIndex(h),pe(o,d*3,l,c),o.needsUpdate=!0,n(o,d,s,r))return!0}return!1}function Eg(i,t,e,n,s,r,o){Xt.setBuffer(i._roots[t]),fn(0,Xt.float32Array,n,r,o)&&bd(0,i,e,n,s,r,o),Xt.clearBuffer()}function bd(i,t,e,n,s,r,o){let{float32Array:a,uint16Array:l,uint32Array:c}=Xt,h=i*2;if(jt(h,l)){let d=ae(i,c),f=ce(h,l);xg(t,e,n,d,f,s,r,o)}else{let d=ne(i);fn(d,a,n,r,o)&&bd(d,t,e,n,s,r,o);let f=ie(i,c);fn(f,a,n,r,o)&&bd(f,t,e,n,s,r,o)}}var HS=["x","y","z"];function Tg(i,t,e,n,s,r){Xt.setBuffer(i._roots[t]);let o=null;return fn(0,Xt.float32Array,n,s,r)&&(o=Sd(0,i,e,n,s,r)),Xt.clearBuffer(),o}function Sd(i,t,e,n,s,r){let{float32Array:o,uint16Array:a,uint32Array:l}=Xt,c=i*2;if(jt(c,a)){let u=ae(i,l),d=ce(c,a);return vg(t,e,n,u,d,s,r)}else{let u=Cr(i,l),d=HS[u],p=n.direction[d]>=0,_,m;p?(_=ne(i),m=ie(i,l)):(_=ie(i,l),m=ne(i));let y=fn(_,o,n,s,r)?Sd(_,t,e,n,s,r):null;if(y){let M=y.point[d];if(p?M<=o[m+u]:M>=o[m+u+3])return y}let v=fn(m,o,n,s,r)?Sd(m,t,e,n,s,r):null;return y&&v?y.distance<=v.distance?y:v:y||v||null}}var qc=new Se,Br=new rn,kr=new rn,Ko=new Pt,Rg=new Pe,Yc=new Pe;function Cg(i,t,e,n){Xt.setBuffer(i._roots[t]);let s=Md(0,i,e,n);return Xt.clearBuffer(),s}function Md(i,t,e,n,s=null){let{float32Array:r,uint16Array:o,uint32Array:a}=Xt,l=i*2;if(s===null&&(e.boundingBox||e.computeBoundingBox(),Rg.set(e.boundingBox.min,e.boundingBox.max,n),s=Rg),jt(l,o)){let h=t.geometry,u=h.index,d=h.attributes.position,f=e.index,p=e.attributes.position,_=ae(i,a),m=ce(l,o);if(Ko.copy(n).invert(),e.boundsTree)return fe(i,r,Yc),Yc.matrix.copy(Ko),Yc.needsUpdate=!0,e.boundsTree.shapecast({intersectsBounds:y=>Yc.intersectsBox(y),intersectsTriangle:y=>{y.a.applyMatrix4(n),y.b.applyMatrix4(n),y.c.applyMatrix4(n),y.needsUpdate=!0;for(let b=_*3,v=(m+_)*3;b<v;b+=3)if(pe(kr,b,u,d),kr.needsUpdate=!0,y.intersectsTriangle(kr))return!0;return!1}});{let g=ys(e);for(let y=_*3,b=(m+_)*3;y<b;y+=3){pe(Br,y,u,d),Br.a.applyMatrix4(Ko),Br.b.applyMatrix4(Ko),Br.c.applyMatrix4(Ko),Br.needsUpdate=!0;for(let v=0,M=g*3;v<M;v+=3)if(pe(kr,v,f,p),kr.needsUpdate=!0,Br.intersectsTriangle(kr))return!0}}}else{let h=ne(i),u=ie(i,a);return fe(h,r,qc),!!(s.intersectsBox(qc)&&Md(h,t,e,n,s)||(fe(u,r,qc),s.intersectsBox(qc)&&Md(u,t,e,n,s)))}}var Zc=new Pt,wd=new Pe,jo=new Pe,WS=new C,$S=new C,XS=new C,qS=new C;function Pg(i,t,e,n={},s={},r=0,o=1/0){t.boundingBox||t.computeBoundingBox(),wd.set(t.boundingBox.min,t.boundingBox.max,e),wd.needsUpdate=!0;let a=i.geometry,l=a.attributes.position,c=a.index,h=t.attributes.position,u=t.index,d=bn.getPrimitive(),f=bn.getPrimitive(),p=WS,_=$S,m=null,g=null;s&&(m=XS,g=qS);let y=1/0,b=null,v=null;return Zc.copy(e).invert(),jo.matrix.copy(Zc),i.shapecast({boundsTraverseOrder:M=>wd.distanceToBox(M),intersectsBounds:(M,A,x)=>x<y&&x<o?(A&&(jo.min.copy(M.min),jo.max.copy(M.max),jo.needsUpdate=!0),!0):!1,intersectsRange:(M,A)=>{if(t.boundsTree)return t.boundsTree.shapecast({boundsTraverseOrder:w=>jo.distanceToBox(w),intersectsBounds:(w,D,R)=>R<y&&R<o,intersectsRange:(w,D)=>{for(let R=w,N=w+D;R<N;R++){pe(f,3*R,u,h),f.a.applyMatrix4(e),f.b.applyMatrix4(e),f.c.applyMatrix4(e),f.needsUpdate=!0;for(let P=M,U=M+A;P<U;P++){pe(d,3*P,c,l),d.needsUpdate=!0;let L=d.distanceToTriangle(f,p,m);if(L<y&&(_.copy(p),g&&g.copy(m),y=L,b=P,v=R),L<r)return!0}}}});{let x=ys(t);for(let w=0,D=x;w<D;w++){pe(f,3*w,u,h),f.a.applyMatrix4(e),f.b.applyMatrix4(e),f.c.applyMatrix4(e),f.needsUpdate=!0;for(let R=M,N=M+A;R<N;R++){pe(d,3*R,c,l),d.needsUpdate=!0;let P=d.distanceToTriangle(f,p,m);if(P<y&&(_.copy(p),g&&g.copy(m),y=P,b=R,v=w),P<r)return!0}}}}}),bn.releasePrimitive(d),bn.releasePrimitive(f),y===1/0?null:(n.point?n.point.copy(_):n.point=_.clone(),n.distance=y,n.faceIndex=b,s&&(s.point?s.point.copy(g):s.point=g.clone(),s.point.applyMatrix4(Zc),_.applyMatrix4(Zc),s.distance=_.sub(s.point).length(),s.faceIndex=v),n)}function Ig(i,t=null){t&&Array.isArray(t)&&(t=new Set(t));let e=i.geometry,n=e.index?e.index.array:null,s=e.attributes.position,r,o,a,l,c=0,h=i._roots;for(let d=0,f=h.length;d<f;d++)r=h[d],o=new Uint32Array(r),a=new Uint16Array(r),l=new Float32Array(r),u(0,c),c+=r.byteLength;function u(d,f,p=!1){let _=d*2;if(jt(_,a)){let m=ae(d,o),g=ce(_,a),y=1/0,b=1/0,v=1/0,M=-1/0,A=-1/0,x=-1/0;for(let w=m,D=m+g;w<D;w++){let R=3*i.resolveTriangleIndex(w);for(let N=0;N<3;N++){let P=R+N;P=n?n[P]:P;let U=s.getX(P),L=s.getY(P),k=s.getZ(P);U<y&&(y=U),U>M&&(M=U),L<b&&(b=L),L>A&&(A=L),k<v&&(v=k),k>x&&(x=k)}}return l[d+0]!==y||l[d+1]!==b||l[d+2]!==v||l[d+3]!==M||l[d+4]!==A||l[d+5]!==x?(l[d+0]=y,l[d+1]=b,l[d+2]=v,l[d+3]=M,l[d+4]=A,l[d+5]=x,!0):!1}else{let m=ne(d),g=ie(d,o),y=p,b=!1,v=!1;if(t){if(!y){let R=m/8+f/32,N=g/8+f/32;b=t.has(R),v=t.has(N),y=!b&&!v}}else b=!0,v=!0;let M=y||b,A=y||v,x=!1;M&&(x=u(m,f,y));let w=!1;A&&(w=u(g,f,y));let D=x||w;if(D)for(let R=0;R<3;R++){let N=m+R,P=g+R,U=l[N],L=l[N+3],k=l[P],z=l[P+3];l[d+R]=U<k?U:k,l[d+R+3]=L>z?L:z}return D}}}function Lg(i,t,e,n,s,r,o){Xt.setBuffer(i._roots[t]),fn(0,Xt.float32Array,n,r,o)&&Ad(0,i,e,n,s,r,o),Xt.clearBuffer()}function Ad(i,t,e,n,s,r,o){let{float32Array:a,uint16Array:l,uint32Array:c}=Xt,h=i*2;if(jt(h,l)){let d=ae(i,c),f=ce(h,l);Mg(t,e,n,d,f,s,r,o)}else{let d=ne(i);fn(d,a,n,r,o)&&Ad(d,t,e,n,s,r,o);let f=ie(i,c);fn(f,a,n,r,o)&&Ad(f,t,e,n,s,r,o)}}var YS=["x","y","z"];function Dg(i,t,e,n,s,r){Xt.setBuffer(i._roots[t]);let o=null;return fn(0,Xt.float32Array,n,s,r)&&(o=Ed(0,i,e,n,s,r)),Xt.clearBuffer(),o}function Ed(i,t,e,n,s,r){let{float32Array:o,uint16Array:a,uint32Array:l}=Xt,c=i*2;if(jt(c,a)){let u=ae(i,l),d=ce(c,a);return wg(t,e,n,u,d,s,r)}else{let u=Cr(i,l),d=YS[u],p=n.direction[d]>=0,_,m;p?(_=ne(i),m=ie(i,l)):(_=ie(i,l),m=ne(i));let y=fn(_,o,n,s,r)?Ed(_,t,e,n,s,r):null;if(y){let M=y.point[d];if(p?M<=o[m+u]:M>=o[m+u+3])return y}let v=fn(m,o,n,s,r)?Ed(m,t,e,n,s,r):null;return y&&v?y.distance<=v.distance?y:v:y||v||null}}var Jc=new Se,zr=new rn,Vr=new rn,Qo=new Pt,Ng=new Pe,Kc=new Pe;function Fg(i,t,e,n){Xt.setBuffer(i._roots[t]);let s=Td(0,i,e,n);return Xt.clearBuffer(),s}function Td(i,t,e,n,s=null){let{float32Array:r,uint16Array:o,uint32Array:a}=Xt,l=i*2;if(s===null&&(e.boundingBox||e.computeBoundingBox(),Ng.set(e.boundingBox.min,e.boundingBox.max,n),s=Ng),jt(l,o)){let h=t.geometry,u=h.index,d=h.attributes.position,f=e.index,p=e.attributes.position,_=ae(i,a),m=ce(l,o);if(Qo.copy(n).invert(),e.boundsTree)return fe(i,r,Kc),Kc.matrix.copy(Qo),Kc.needsUpdate=!0,e.boundsTree.shapecast({intersectsBounds:y=>Kc.intersectsBox(y),intersectsTriangle:y=>{y.a.applyMatrix4(n),y.b.applyMatrix4(n),y.c.applyMatrix4(n),y.needsUpdate=!0;for(let b=_,v=m+_;b<v;b++)if(pe(Vr,3*t.resolveTriangleIndex(b),u,d),Vr.needsUpdate=!0,y.intersectsTriangle(Vr))return!0;return!1}});{let g=ys(e);for(let y=_,b=m+_;y<b;y++){let v=t.resolveTriangleIndex(y);pe(zr,3*v,u,d),zr.a.applyMatrix4(Qo),zr.b.applyMatrix4(Qo),zr.c.applyMatrix4(Qo),zr.needsUpdate=!0;for(let M=0,A=g*3;M<A;M+=3)if(pe(Vr,M,f,p),Vr.needsUpdate=!0,zr.intersectsTriangle(Vr))return!0}}}else{let h=ne(i),u=ie(i,a);return fe(h,r,Jc),!!(s.intersectsBox(Jc)&&Td(h,t,e,n,s)||(fe(u,r,Jc),s.intersectsBox(Jc)&&Td(u,t,e,n,s)))}}var jc=new Pt,Rd=new Pe,ta=new Pe,ZS=new C,JS=new C,KS=new C,jS=new C;function Ug(i,t,e,n={},s={},r=0,o=1/0){t.boundingBox||t.computeBoundingBox(),Rd.set(t.boundingBox.min,t.boundingBox.max,e),Rd.needsUpdate=!0;let a=i.geometry,l=a.attributes.position,c=a.index,h=t.attributes.position,u=t.index,d=bn.getPrimitive(),f=bn.getPrimitive(),p=ZS,_=JS,m=null,g=null;s&&(m=KS,g=jS);let y=1/0,b=null,v=null;return jc.copy(e).invert(),ta.matrix.copy(jc),i.shapecast({boundsTraverseOrder:M=>Rd.distanceToBox(M),intersectsBounds:(M,A,x)=>x<y&&x<o?(A&&(ta.min.copy(M.min),ta.max.copy(M.max),ta.needsUpdate=!0),!0):!1,intersectsRange:(M,A)=>{if(t.boundsTree){let x=t.boundsTree;return x.shapecast({boundsTraverseOrder:w=>ta.distanceToBox(w),intersectsBounds:(w,D,R)=>R<y&&R<o,intersectsRange:(w,D)=>{for(let R=w,N=w+D;R<N;R++){let P=x.resolveTriangleIndex(R);pe(f,3*P,u,h),f.a.applyMatrix4(e),f.b.applyMatrix4(e),f.c.applyMatrix4(e),f.needsUpdate=!0;for(let U=M,L=M+A;U<L;U++){let k=i.resolveTriangleIndex(U);pe(d,3*k,c,l),d.needsUpdate=!0;let z=d.distanceToTriangle(f,p,m);if(z<y&&(_.copy(p),g&&g.copy(m),y=z,b=U,v=R),z<r)return!0}}}})}else{let x=ys(t);for(let w=0,D=x;w<D;w++){pe(f,3*w,u,h),f.a.applyMatrix4(e),f.b.applyMatrix4(e),f.c.applyMatrix4(e),f.needsUpdate=!0;for(let R=M,N=M+A;R<N;R++){let P=i.resolveTriangleIndex(R);pe(d,3*P,c,l),d.needsUpdate=!0;let U=d.distanceToTriangle(f,p,m);if(U<y&&(_.copy(p),g&&g.copy(m),y=U,b=R,v=w),U<r)return!0}}}}}),bn.releasePrimitive(d),bn.releasePrimitive(f),y===1/0?null:(n.point?n.point.copy(_):n.point=_.clone(),n.distance=y,n.faceIndex=b,s&&(s.point?s.point.copy(g):s.point=g.clone(),s.point.applyMatrix4(jc),_.applyMatrix4(jc),s.distance=_.sub(s.point).length(),s.faceIndex=v),n)}function Cd(i,t,e){return i===null?null:(i.point.applyMatrix4(t.matrixWorld),i.distance=i.point.distanceTo(e.ray.origin),i.object=t,i)}var Qc=new Pe,th=new ri,Og=new C,Bg=new Pt,kg=new C,Pd=["getX","getY","getZ"],eh=class i extends Gc{static serialize(t,e={}){e={cloneBuffers:!0,...e};let n=t.geometry,s=t._roots,r=t._indirectBuffer,o=n.getIndex(),a={version:1,roots:null,index:null,indirectBuffer:null};return e.cloneBuffers?(a.roots=s.map(l=>l.slice()),a.index=o?o.array.slice():null,a.indirectBuffer=r?r.slice():null):(a.roots=s,a.index=o?o.array:null,a.indirectBuffer=r),a}static deserialize(t,e,n={}){n={setIndex:!0,indirect:!!t.indirectBuffer,...n};let{index:s,roots:r,indirectBuffer:o}=t;t.version||(console.warn("MeshBVH.deserialize: Serialization format has been changed and will be fixed up. It is recommended to regenerate any stored serialized data."),l(r));let a=new i(e,{...n,[$o]:!0});if(a._roots=r,a._indirectBuffer=o||null,n.setIndex){let c=e.getIndex();if(c===null){let h=new Ht(t.index,1,!1);e.setIndex(h)}else c.array!==s&&(c.array.set(s),c.needsUpdate=!0)}return a;function l(c){for(let h=0;h<c.length;h++){let u=c[h],d=new Uint32Array(u),f=new Uint16Array(u);for(let p=0,_=u.byteLength/32;p<_;p++){let m=8*p,g=2*m;jt(g,f)||(d[m+6]=d[m+6]/8-p)}}}}get primitiveStride(){return 3}get resolveTriangleIndex(){return this.resolvePrimitiveIndex}constructor(t,e={}){e.maxLeafTris&&(console.warn('MeshBVH: "maxLeafTris" option has been deprecated. Use "targetLeafSize", instead.'),e={...e,targetLeafSize:e.maxLeafTris}),super(t,e)}shiftTriangleOffsets(t){return super.shiftPrimitiveOffsets(t)}writePrimitiveBounds(t,e,n){let s=this.geometry,r=this._indirectBuffer,o=s.attributes.position,a=s.index?s.index.array:null,c=(r?r[t]:t)*3,h=c+0,u=c+1,d=c+2;a&&(h=a[h],u=a[u],d=a[d]);for(let f=0;f<3;f++){let p=o[Pd[f]](h),_=o[Pd[f]](u),m=o[Pd[f]](d),g=p;_<g&&(g=_),m<g&&(g=m);let y=p;_>y&&(y=_),m>y&&(y=m),e[n+f]=g,e[n+f+3]=y}return e}computePrimitiveBounds(t,e,n){let s=this.geometry,r=this._indirectBuffer,o=s.attributes.position,a=s.index?s.index.array:null,l=o.normalized;if(t<0||e+t-n.offset>n.length/6)throw new Error("MeshBVH: compute triangle bounds range is invalid.");let c=o.array,h=o.offset||0,u=3;o.isInterleavedBufferAttribute&&(u=o.data.stride);let d=["getX","getY","getZ"],f=n.offset;for(let p=t,_=t+e;p<_;p++){let g=(r?r[p]:p)*3,y=(p-f)*6,b=g+0,v=g+1,M=g+2;a&&(b=a[b],v=a[v],M=a[M]),l||(b=b*u+h,v=v*u+h,M=M*u+h);for(let A=0;A<3;A++){let x,w,D;l?(x=o[d[A]](b),w=o[d[A]](v),D=o[d[A]](M)):(x=c[b+A],w=c[v+A],D=c[M+A]);let R=x;w<R&&(R=w),D<R&&(R=D);let N=x;w>N&&(N=w),D>N&&(N=D);let P=(N-R)/2,U=A*2;n[y+U+0]=R+P,n[y+U+1]=P+(Math.abs(R)+P)*Rr}}return n}raycastObject3D(t,e,n=[]){let{material:s}=t;if(s===void 0)return;Bg.copy(t.matrixWorld).invert(),th.copy(e.ray).applyMatrix4(Bg),kg.setFromMatrixScale(t.matrixWorld),Og.copy(th.direction).multiply(kg);let r=Og.length(),o=e.near/r,a=e.far/r;if(e.firstHitOnly===!0){let l=this.raycastFirst(th,s,o,a);l=Cd(l,t,e),l&&n.push(l)}else{let l=this.raycast(th,s,o,a);for(let c=0,h=l.length;c<h;c++){let u=Cd(l[c],t,e);u&&n.push(u)}}return n}refit(t=null){return(this.indirect?Ig:Sg)(this,t)}raycast(t,e=oi,n=0,s=1/0){let r=this._roots,o=[],a=this.indirect?Lg:Eg;for(let l=0,c=r.length;l<c;l++)a(this,l,e,t,o,n,s);return o}raycastFirst(t,e=oi,n=0,s=1/0){let r=this._roots,o=null,a=this.indirect?Dg:Tg;for(let l=0,c=r.length;l<c;l++){let h=a(this,l,e,t,n,s);h!=null&&(o==null||h.distance<o.distance)&&(o=h)}return o}intersectsGeometry(t,e){let n=!1,s=this._roots,r=this.indirect?Fg:Cg;for(let o=0,a=s.length;o<a&&(n=r(this,o,t,e),!n);o++);return n}shapecast(t){let e=bn.getPrimitive(),n=super.shapecast({...t,intersectsPrimitive:t.intersectsTriangle,scratchPrimitive:e,iterate:this.indirect?Ag:bg});return bn.releasePrimitive(e),n}bvhcast(t,e,n){let{intersectsRanges:s,intersectsTriangles:r}=n,o=bn.getPrimitive(),a=this.geometry.index,l=this.geometry.attributes.position,c=this.indirect?p=>{let _=this.resolveTriangleIndex(p);pe(o,_*3,a,l)}:p=>{pe(o,p*3,a,l)},h=bn.getPrimitive(),u=t.geometry.index,d=t.geometry.attributes.position,f=t.indirect?p=>{let _=t.resolveTriangleIndex(p);pe(h,_*3,u,d)}:p=>{pe(h,p*3,u,d)};if(r){if(!(t instanceof i))throw new Error('MeshBVH: "intersectsTriangles" callback can only be used with another MeshBVH.');let p=(_,m,g,y,b,v,M,A)=>{for(let x=g,w=g+y;x<w;x++){f(x),h.a.applyMatrix4(e),h.b.applyMatrix4(e),h.c.applyMatrix4(e),h.needsUpdate=!0;for(let D=_,R=_+m;D<R;D++)if(c(D),o.needsUpdate=!0,r(o,h,D,x,b,v,M,A))return!0}return!1};if(s){let _=s;s=function(m,g,y,b,v,M,A,x){return _(m,g,y,b,v,M,A,x)?!0:p(m,g,y,b,v,M,A,x)}}else s=p}return super.bvhcast(t,e,{intersectsRanges:s})}intersectsBox(t,e){return Qc.set(t.min,t.max,e),Qc.needsUpdate=!0,this.shapecast({intersectsBounds:n=>Qc.intersectsBox(n),intersectsTriangle:n=>Qc.intersectsTriangle(n)})}intersectsSphere(t){return this.shapecast({intersectsBounds:e=>t.intersectsBox(e),intersectsTriangle:e=>e.intersectsSphere(t)})}closestPointToGeometry(t,e,n={},s={},r=0,o=1/0){return(this.indirect?Ug:Pg)(this,t,e,n,s,r,o)}closestPointToPoint(t,e={},n=0,s=1/0){return fg(this,t,e,n,s)}};var zg=null,QS=0,Gr=class{constructor(t,e,n){this.points=t;this.corners=e;zg??=new Worker("worker.js",{type:"module"});let s=zg,r=++QS,o=a=>{if(a.data.id!==r)return;s.removeEventListener("message",o);let l=new Me;l.setAttribute("position",new Ht(t,3)),l.setIndex(new Ht(e,1)),this.tree=eh.deserialize(a.data.tree,l,{setIndex:!1}),n()};s.addEventListener("message",o),s.postMessage({id:r,points:t,corners:e})}points;corners;tree=null;get isReady(){return this.tree!==null}first(t){let e=this.tree?.raycastFirst(t,Te);return e&&e.faceIndex!=null?{triangle:e.faceIndex,point:e.point,distance:e.distance}:null}shares(t,e){let n=v=>{let M=3*this.corners[3*t+v];return[this.points[M],this.points[M+1],this.points[M+2]]},[s,r,o]=[n(0),n(1),n(2)],a=(v,M)=>[v[0]-M[0],v[1]-M[1],v[2]-M[2]],l=(v,M)=>v[0]*M[0]+v[1]*M[1]+v[2]*M[2],[c,h,u]=[a(r,s),a(o,s),a([e.x,e.y,e.z],s)],[d,f,p,_,m]=[l(c,c),l(c,h),l(h,h),l(u,c),l(u,h)],g=d*p-f*f;if(g<=0)return[1,0,0];let y=(p*_-f*m)/g,b=(d*m-f*_)/g;return[1-y-b,y,b]}};var tM=[178,188,196],Id=[245,196,66],Ld=[70,130,190],na=[226,120,58],Dd=[60,150,80],Nd=[190,60,120],eM=Math.cos(20*Math.PI/180),nh=10,xs=16,ea=1024,[nM,iM]=[Dd,Nd].map(i=>`${i.join(".0, ")}.0`),sM=`
in float face; in float paint; out vec3 at; out vec3 rest; flat out int number; flat out int painted;
void main() { number = int(face + 0.5); painted = int(paint + 0.5); rest = position; vec4 eye = modelViewMatrix * vec4(position, 1.0); at = eye.xyz; gl_Position = projectionMatrix * eye; }`,sh="vec3 n = normalize(cross(dFdx(at), dFdy(at))); if (dot(n, at) > 0.0) n = -n; float lit = max(dot(n, normalize(vec3(0.25, 0.45, 0.86))), 0.0);",rM=`
in vec3 at; in vec3 rest; flat in int number; flat in int painted; out vec4 result; uniform sampler2D faces; uniform int hovered;
uniform int cuts; uniform int cutFace[${xs}]; uniform vec4 cutPlane[${xs}]; uniform vec3 cutColour[${xs}];
void main() {
  ${sh}
  vec3 colour = texelFetch(faces, ivec2(number % ${ea}, number / ${ea}), 0).rgb;
  for (int k = 0; k < cuts; k++) if (number == cutFace[k] && dot(cutPlane[k].xyz, rest) >= cutPlane[k].w) colour = cutColour[k] / 255.0;
  if (painted == 1) colour = vec3(${nM}) / 255.0;
  if (painted == 2) colour = vec3(${iM}) / 255.0;
  if (number == hovered) colour = mix(colour, vec3(1.0, 0.97, 0.62), 0.55);
  result = vec4(colour * (0.5 + 0.55 * lit), 1.0);
}`,Vg=`
in float value; in vec3 moved; uniform float magnify; out vec3 at; out vec3 rest; out float v;
void main() { v = value; rest = position; vec4 eye = modelViewMatrix * vec4(position + magnify * moved, 1.0); at = eye.xyz; gl_Position = projectionMatrix * eye; }`,Gg=`
in vec3 at; in vec3 rest; in float v; out vec4 result; uniform sampler2D colours; uniform vec2 scale; uniform vec4 clip; uniform float opacity;
void main() {
  if (dot(clip.xyz, rest) > clip.w) discard;
  ${sh}
  float t = clamp((v - scale.x) / max(scale.y - scale.x, 1e-12), 0.0, 1.0);
  result = vec4(texture(colours, vec2(t * (255.0 / 256.0) + 0.5 / 256.0, 0.5)).rgb * (0.82 + 0.18 * lit), opacity);
}`,Fd=[200,30,40],Ud=[30,70,205],Od=[214,120,0],Bd=[208,31,60],oM=2.5,aM=3,lM=4,cM=`
in vec4 a; in vec4 b; uniform vec2 pixels; uniform float wide; out vec3 rest; out float v;
void main() {
  vec4 here = position.x < 0.5 ? a : b; rest = here.xyz; v = here.w;
  vec4 p = projectionMatrix * modelViewMatrix * vec4(a.xyz, 1.0); vec4 q = projectionMatrix * modelViewMatrix * vec4(b.xyz, 1.0);
  vec2 along = (q.xy / q.w - p.xy / p.w) * pixels; along /= max(length(along), 1e-6);
  vec4 end = position.x < 0.5 ? p : q;
  gl_Position = end + vec4(vec2(-along.y, along.x) * position.y * wide / pixels * end.w, 0.0, 0.0);
}`,hM=`
in vec3 rest; in float v; out vec4 result; uniform vec4 clip;
void main() { if (dot(clip.xyz, rest) > clip.w) discard; result = vec4(v > 0.0 ? vec3(${Fd.join(".0, ")}.0) / 255.0 : vec3(${Ud.join(".0, ")}.0) / 255.0, 1.0); }`,kd=[20,20,20],zd=[255,255,255],uM=11,dM=.16;function qg(i){let[t,e,n,s,r]=new Uint32Array(i,0,5),o=20,a=(l,c)=>{let h=new l(i,o,c);return o+=4*c,h};return{points:a(Float32Array,3*t),corners:a(Uint32Array,3*e),face:a(Uint32Array,e),faulty:a(Float32Array,6*n),borders:a(Uint32Array,2*s),faults:a(Float32Array,6*r)}}function fM(i,{point:t,normal:e}){let n=i.map(r=>r.clone().sub(t).dot(e)),s=[];return i.forEach((r,o)=>{let a=(o+1)%3;n[o]>=0&&s.push(r),n[o]*n[a]<0&&s.push(r.clone().lerp(i[a],n[o]/(n[o]-n[a])))}),s.slice(2).map((r,o)=>[s[0],s[o+1],r])}var Vd=[["mises","von Mises stress","MPa"],["first","greatest principal stress","MPa"],["third","smallest principal stress","MPa"],["moved","displacement","mm"]];function rh(i,t=0){let[e,n,s,r,o,a]=[i[t],i[t+1],i[t+2],i[t+3],i[t+4],i[t+5]],l=(e+n+s)/3,[c,h,u]=[e-l,n-l,s-l],d=Math.sqrt((c*c+h*h+u*u+2*(r*r+o*o+a*a))/6);if(d<1e-30)return[l,l,l];let f=(c*(h*u-o*o)-r*(r*u-o*a)+a*(r*o-h*a))/(2*d*d*d),p=Math.acos(Math.min(Math.max(f,-1),1))/3,_=l+2*d*Math.cos(p),m=l+2*d*Math.cos(p+2*Math.PI/3);return[_,3*l-_-m,m]}function lh(i,t=0){let[e,n,s,r,o,a]=[i[t],i[t+1],i[t+2],i[t+3],i[t+4],i[t+5]];return Math.sqrt(Math.max(.5*((e-n)**2+(n-s)**2+(s-e)**2)+3*(r*r+o*o+a*a),0))}function pM(i,t,e){switch(i){case"mises":return lh(t,e);case"first":return rh(t,e)[0];case"third":return rh(t,e)[2];case"moved":return Math.hypot(t[e+6],t[e+7],t[e+8])}}var ih=.995,oh=class{group=new ze;mesh;section=null;lines=null;degeneratePoints=null;what="mises";material;search;nine=new Float32Array(0);points;corners;constructor(t,e){let[n,s]=new Uint32Array(t,0,2);this.points=new Float32Array(t,8,3*n),this.corners=new Uint32Array(t,8+12*n,3*s);let r=new Me;r.setAttribute("position",new Ht(this.points,3)),r.setAttribute("value",new Ht(new Float32Array(n),1)),r.setAttribute("moved",new Ht(new Float32Array(3*n),3)),r.setIndex(new Ht(this.corners,1));let o=new mi(ya(Ln),256,1,sn);o.minFilter=o.magFilter=ye,o.needsUpdate=!0,this.material=new Ie({glslVersion:Cn,vertexShader:Vg,fragmentShader:Gg,side:Te,uniforms:{colours:{value:o},scale:{value:new St(0,1)},magnify:{value:0},clip:{value:new de(0,0,0,1)},opacity:{value:1}}}),this.mesh=new Ee(r,this.material),this.mesh.frustumCulled=!1,this.group.add(this.mesh),this.search=new Gr(this.points,this.corners,e)}setSection(t,e,n,s){this.section&&(this.group.remove(this.section.mesh),this.section.mesh.geometry.dispose(),this.section.mesh.material.dispose(),this.section=null);let r=this.material.uniforms.clip.value;if(r.set(0,0,0,1),!t)return;r.setComponent(e,s?1:-1).setW(s?n:-n);let[o,a]=new Uint32Array(t,0,2),l=new Float32Array(t,8,3*o),c=new Uint32Array(t,8+12*o,3*a),h=new Float32Array(t,8+12*o+12*a,9*o),u=new Me;u.setAttribute("position",new Ht(l,3)),u.setAttribute("value",new Ht(new Float32Array(o),1)),u.setAttribute("moved",new Ht(Float32Array.from({length:3*o},(p,_)=>h[9*Math.floor(_/3)+6+_%3]),3)),u.setIndex(new Ht(c,1));let d={clip:{value:new de(0,0,0,1)},opacity:{value:1}},f=new Ee(u,new Ie({glslVersion:Cn,vertexShader:Vg,fragmentShader:Gg,side:Te,uniforms:{...this.material.uniforms,...d}}));f.frustumCulled=!1,this.group.add(f),this.section={mesh:f,nine:h,corners:c,search:new Gr(l,c,()=>{})},this.values(f,h)}get hasLines(){return this.lines!==null}setLines(t){this.lines&&(this.group.remove(this.lines),this.lines.geometry.dispose(),this.lines.material.dispose(),this.lines=null);let e=t?new Uint32Array(t,0,1)[0]:0;if(this.material.uniforms.opacity.value=e>0?dM:1,this.material.transparent=e>0,this.material.depthWrite=e===0,!t||e===0)return;let n=new Uint32Array(t,4,e),s=new Float32Array(t,4+4*e),r=[],o=0;for(let a of n){for(let l=o;l+1<o+a;l++)r.push(...s.subarray(4*l,4*l+8));o+=a}this.lines=Yg(new Float32Array(r),oM,hM,{clip:this.material.uniforms.clip}),this.group.add(this.lines)}setDegenerate(t){if(this.degeneratePoints&&(this.group.remove(this.degeneratePoints),this.degeneratePoints.geometry.dispose(),this.degeneratePoints.material.dispose(),this.degeneratePoints=null),t===null)return[];let e=Qm(this.points,this.corners,this.nine,t),n=new Me;n.setAttribute("position",new Ht(new Float32Array(e.flatMap(o=>o.at)),3)),n.setAttribute("wedge",new Ht(Float32Array.from(e,o=>Number(o.isWedge)),1));let s=o=>`vec3(${o.join(".0, ")}.0) / 255.0`,r=new Ie({glslVersion:Cn,uniforms:{clip:this.material.uniforms.clip,size:{value:uM}},vertexShader:"in float wedge; uniform float size; out float kind; out vec3 rest; void main() { kind = wedge; rest = position; gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0); gl_Position.z -= 1e-4 * gl_Position.w; gl_PointSize = size; }",fragmentShader:`in float kind; in vec3 rest; uniform vec4 clip; out vec4 result; void main() { float r = length(gl_PointCoord - 0.5); if (r > 0.5 || dot(clip.xyz, rest) > clip.w) discard; vec3 inner = kind > 0.5 ? ${s(kd)} : ${s(zd)}; result = vec4(r > 0.36 ? 1.0 - inner : inner, 1.0); }`});return this.degeneratePoints=new bo(n,r),this.degeneratePoints.frustumCulled=!1,this.degeneratePoints.renderOrder=3,this.group.add(this.degeneratePoints),e}values(t,e){let n=t.geometry.getAttribute("value"),s=n.array;for(let r=0;r<s.length;r++)s[r]=pM(this.what,e,9*r);return n.needsUpdate=!0,s}take(t){this.nine=t;let e=this.mesh.geometry.getAttribute("moved");for(let n=0;n<t.length/9;n++)e.setXYZ(n,t[9*n+6],t[9*n+7],t[9*n+8]);e.needsUpdate=!0}colour(t){this.what=t;let e=this.values(this.mesh,this.nine);this.section&&this.values(this.section.mesh,this.section.nine);let n=e.slice().sort(),s=a=>n[Math.min(Math.floor(a*n.length),n.length-1)]??0,o=t==="moved"?[0,s(1)]:[t==="first"||t==="third"?Math.min(s(1-ih),0):0,s(ih)];return t==="third"&&(o[1]=Math.max(s(ih),0)),{low:n[0]??0,high:s(1),proposed:o}}get misesEnd(){let t=Float32Array.from({length:this.nine.length/9},(e,n)=>lh(this.nine,9*n)).sort();return t[Math.min(Math.floor(ih*t.length),t.length-1)]??0}setScale(t,e){this.material.uniforms.scale.value.set(t,e)}setMagnified(t){this.material.uniforms.magnify.value=t}get largestMove(){let t=0;for(let e=0;e<this.nine.length;e+=9)t=Math.max(t,Math.hypot(this.nine[e+6],this.nine[e+7],this.nine[e+8]));return t}probe(t){let e=this.material.uniforms.clip.value,n=new C(e.x,e.y,e.z),s=n.dot(t.origin)-e.w,r=null,o=this;if(this.section&&s>0){let d=-s/n.dot(t.direction);if(!(d>0))return null;r=this.section.search.first(t),r?o=this.section:t=t.clone().recast(d)}if(r??=this.search.first(t),!r||n.dot(r.point)>e.w+.001)return null;let{search:a,nine:l,corners:c}=o,h=a.shares(r.triangle,r.point),u=r.triangle;return{at:r.point,nine:Array.from({length:9},(d,f)=>h.reduce((p,_,m)=>p+_*l[9*c[3*u+m]+f],0))}}dispose(){this.setSection(null,0,0,!0),this.setLines(null),this.setDegenerate(null),this.material.uniforms.colours.value.dispose(),this.material.dispose(),this.mesh.geometry.dispose()}},ah=class{constructor(t,e){this.surface=t;let{points:n,corners:s,face:r,faulty:o,borders:a,faults:l}=t,c=s.length/3,h=new Float32Array(9*c),u=new Float32Array(3*c),d=-1;for(let _=0;_<c;_++){let m=r[_]===4294967295?-1:r[_];d=Math.max(d,m);for(let g=0;g<3;g++){let y=3*s[3*_+g];for(let b=0;b<3;b++)h[9*_+3*g+b]=n[y+b]}}this.faces=d+1;for(let _=0;_<c;_++)u.fill(r[_]===4294967295?this.faces:r[_],3*_,3*_+3);for(let _=0;_<n.length;_+=3)this.low.min(new C(n[_],n[_+1],n[_+2])),this.high.max(new C(n[_],n[_+1],n[_+2]));let f=new Me;f.setAttribute("position",new Ht(h,3)),f.setAttribute("face",new Ht(u,1)),this.paintOf=new Ht(new Uint8Array(3*c),1),f.setAttribute("paint",this.paintOf);let p=Math.ceil((this.faces+1)/ea);this.colours=new mi(new Uint8Array(4*ea*p),ea,p,sn),this.colours.minFilter=this.colours.magFilter=ye,this.material=new Ie({glslVersion:Cn,vertexShader:sM,fragmentShader:rM,side:Te,polygonOffset:!0,polygonOffsetFactor:1,polygonOffsetUnits:1,uniforms:{faces:{value:this.colours},hovered:{value:-1},cuts:{value:0},cutFace:{value:new Array(xs).fill(-1)},cutPlane:{value:Array.from({length:xs},()=>new de)},cutColour:{value:Array.from({length:xs},()=>new C)}}}),this.mesh=new Ee(f,this.material),this.mesh.frustumCulled=!1,this.borders=mM(Float32Array.from({length:3*a.length},(_,m)=>n[3*a[Math.floor(m/3)]+m%3]),3950157,.75),this.faults=[Wg(l,aM,Od,1),Wg(o,lM,Bd,2)],this.group.add(this.mesh,this.borders,...this.faults,this.marks,this.branches),this.paint(new Map),this.search=new Gr(n,s,e)}surface;group=new ze;low=new C(1/0,1/0,1/0);high=new C(-1/0,-1/0,-1/0);faces;search;mesh;borders;faults;marks=new ze;material;colours;patches=new Map;trianglesOf=[];pairs=null;stressed=null;paintOf;branches=new ze;branchRows=new Float32Array(0);paint(t){let e=this.colours.image.data;for(let n=0;n<=this.faces;n++)e.set([...t.get(n)??tM,255],4*n);this.colours.needsUpdate=!0}paintParts(t){let e=this.material.uniforms;e.cuts.value=Math.min(t.length,xs),t.slice(0,xs).forEach(({face:n,side:s,colour:r},o)=>{e.cutFace.value[o]=n,e.cutPlane.value[o].set(s.normal.x,s.normal.y,s.normal.z,s.normal.dot(s.point)),e.cutColour.value[o].fromArray(r)})}pointAt(t){let e=this.search.first(t);if(!e)return null;let[n,s,r]=[0,1,2].map(o=>new C().fromArray(this.surface.points,3*this.surface.corners[3*e.triangle+o]));return{face:this.surface.face[e.triangle],point:e.point.clone(),normal:s.sub(n).cross(r.sub(n)).normalize()}}set hovered(t){this.material.uniforms.hovered.value=t}get hovered(){return this.material.uniforms.hovered.value}faceAt(t){let e=this.search.first(t),n=e?this.surface.face[e.triangle]:4294967295;return n===4294967295?-1:n}facesIn(t,[e,n,s,r]){let{points:o,corners:a,face:l}=this.surface,c=t.elements,h=new Uint8Array(o.length/3);for(let d=0;d<h.length;d++){let[f,p,_]=[o[3*d],o[3*d+1],o[3*d+2]],m=y=>c[y]*f+c[y+4]*p+c[y+8]*_+c[y+12],g=m(3);h[d]=g>0&&m(0)>=e*g&&m(0)<=s*g&&m(1)>=n*g&&m(1)<=r*g?1:0}let u=new Uint8Array(this.faces).fill(1);return l.forEach((d,f)=>{d!==4294967295&&!(h[a[3*f]]&h[a[3*f+1]]&h[a[3*f+2]])&&(u[d]=0)}),[...u.keys()].filter(d=>u[d]===1)}beside(t,e){let{points:n,corners:s,face:r,borders:o}=this.surface;if(!this.pairs){this.pairs=[];let c=n.length/3,h=(f,p)=>Math.min(f,p)*c+Math.max(f,p),u=new Map;for(let f=0;f<o.length;f+=2)u.set(h(o[f],o[f+1]),[]);for(let f=0;f<r.length;f++)for(let p=0;p<3;p++)u.get(h(s[3*f+p],s[3*f+(p+1)%3]))?.push(f);let d=f=>{let[p,_,m]=[0,1,2].map(g=>new C().fromArray(n,3*s[3*f+g]));return _.sub(p).cross(m.sub(p)).normalize()};for(let[f,p]of u.values())f!==void 0&&p!==void 0&&this.pairs.push([r[f],r[p],d(f).dot(d(p))>eM])}let a=new Set(t),l=new Set;for(let[c,h,u]of this.pairs)e&&!u||(a.has(c)&&l.add(h),a.has(h)&&l.add(c));return[...l].filter(c=>c!==4294967295&&!a.has(c))}setPainted(t,e){let n=this.paintOf.array;n.fill(0);for(let[s,r]of[[t,1],[e,2]])for(let o of s)n.fill(r,3*o,3*o+3);this.paintOf.needsUpdate=!0}setBranches(t){for(let l of this.branches.children)l.geometry.dispose(),l.material.dispose();this.branches.clear(),this.branchRows=t??new Float32Array(0);let e=0;for(let l=0;l<this.branchRows.length;l+=nh)e=Math.max(e,this.branchRows[l+8]);if(this.branchRows.length===0)return e;let n=new ki,s=new Oi(1,1,1,9,1,!0);n.index=s.index,n.setAttribute("position",s.getAttribute("position"));let r=new zi(this.branchRows.slice(),nh);n.setAttribute("high",new xn(r,4,0)),n.setAttribute("low",new xn(r,4,4)),n.setAttribute("load",new xn(r,1,8)),n.instanceCount=this.branchRows.length/nh;let o=new Ie({glslVersion:Cn,side:Te,vertexShader:`in vec4 high; in vec4 low; in float load; uniform float most; out vec3 at; out vec3 tone;
vec3 ramp(float t) { vec3 all[9] = vec3[9](${Array.from({length:9},(l,c)=>`vec3(${Ln(c/8).map(h=>(h/255).toFixed(4)).join(", ")})`).join(", ")}); float s = clamp(t, 0.0, 1.0) * 8.0; int k = min(int(s), 7); return mix(all[k], all[k + 1], s - float(k)); }
void main() {
  vec3 along = high.xyz - low.xyz; along = length(along) > 1e-6 ? normalize(along) : vec3(0.0, 0.0, 1.0);
  vec3 u = normalize(cross(along, abs(along.x) < 0.7 ? vec3(1.0, 0.0, 0.0) : vec3(0.0, 1.0, 0.0))); vec3 v = cross(along, u);
  vec4 end = position.y > 0.0 ? high : low;
  vec4 eye = modelViewMatrix * vec4(end.xyz + end.w * (u * position.x + v * position.z), 1.0);
  tone = ramp(load / max(most, 1e-9)); at = eye.xyz; gl_Position = projectionMatrix * eye;
}`,fragmentShader:`in vec3 at; in vec3 tone; out vec4 result; void main() { ${sh} result = vec4(tone * (0.72 + 0.33 * lit), 1.0); }`,uniforms:{most:{value:e}}}),a=new Ee(n,o);return a.frustumCulled=!1,this.branches.add(a),e}showBranches(t){this.branches.visible=t}branchAt(t){let e=this.branchRows,n=this.search.first(t)?.distance??1/0,s=null,[r,o,a,l]=[new C,new C,new C,new C];for(let c=0;c<e.length;c+=nh){r.fromArray(e,c),o.fromArray(e,c+4);let h=t.distanceSqToSegment(r,o,a,l),u=r.distanceTo(o),d=u>0?l.distanceTo(r)/u:0,f=e[c+3]*(1-d)+e[c+7]*d,p=a.distanceTo(t.origin);h>f*f||p>n+f||s&&s.far<=p||(s={load_n:e[c+8],isContact:e[c+9]>.5,at:l.clone(),far:p})}return s}triangles(t){if(this.trianglesOf.length===0){let e=new Uint32Array(this.faces);for(let n of this.surface.face)n!==4294967295&&e[n]++;for(let n=0;n<this.faces;n++)this.trianglesOf.push(new Uint32Array(e[n]));e.fill(0),this.surface.face.forEach((n,s)=>{n!==4294967295&&(this.trianglesOf[n][e[n]++]=s)})}return this.trianglesOf[t]??new Uint32Array(0)}defects(){let[t,e]=[Hg(this.surface.faulty),Hg(this.surface.faults)],n=1e-5*this.high.distanceTo(this.low);return[...t,...e.filter(s=>t.every(r=>r.distanceTo(s)>n))]}patch(t,e=null){let n=e?void 0:this.patches.get(t);if(n)return n;let{points:s,corners:r}=this.surface,o=(b,v)=>new C().fromArray(s,3*r[3*b+v]),a=e?Array.from(this.triangles(t),b=>fM([0,1,2].map(v=>o(b,v)),e)).flat():null,l=a?(b,v)=>a[b][v].clone():o,c=a?Uint32Array.from(a.keys()):this.triangles(t),[h,u]=[new C,new C],d=new Float64Array(c.length),f=0,p=b=>{let v=l(b,0);return new C().crossVectors(l(b,1).sub(v),l(b,2).sub(v)).multiplyScalar(.5)};c.forEach((b,v)=>{let M=p(b),A=M.length();f+=A,d[v]=f,u.add(M),h.addScaledVector(l(b,0).add(l(b,1)).add(l(b,2)),A/3)}),f>0&&h.divideScalar(f);let[_,m]=[[],[]],g=9;for(let b=0,v=0;b<g&&f>0;b++){let M=f*(b+.5)/g;for(;v+1<c.length&&d[v]<M;)v++;let A=c[v],[x,w]=[(.5+.7548776662*b)%1,(.5+.569840291*b)%1];x+w>1&&([x,w]=[1-x,1-w]);let D=l(A,0);_.push(D.clone().addScaledVector(l(A,1).sub(D),x).addScaledVector(l(A,2).sub(D),w)),m.push(p(A).normalize())}let y={area:f,middle:h,normal:u.length()>.001*f?u.normalize():new C,spread:_,normals:m};return e||this.patches.set(t,y),y}setArrows(t){for(let a of this.marks.children)a.geometry.dispose(),a.material.dispose();if(this.marks.clear(),t.length===0)return;let[e,n]=[[],[]];for(let a of t){let l=new Oe().setFromUnitVectors(new C(0,1,0),a.along.clone().normalize()),c=new Pt().compose(a.at,l,new C(a.length,a.length,a.length)),h=a.isCone?[_M]:a.heads===2?[$g,Xg,gM]:[$g,Xg];for(let u of h)for(let d=0;d<u.length;d+=3){let f=new C(u[d],u[d+1],u[d+2]).applyMatrix4(c);e.push(f.x,f.y,f.z),n.push(...a.colour.map(p=>p/255))}}let s=new Me;s.setAttribute("position",new Ht(new Float32Array(e),3)),s.setAttribute("colour",new Ht(new Float32Array(n),3));let r=new Ie({glslVersion:Cn,side:Te,vertexShader:"in vec3 colour; out vec3 at; out vec3 tone; void main() { tone = colour; vec4 eye = modelViewMatrix * vec4(position, 1.0); at = eye.xyz; gl_Position = projectionMatrix * eye; }",fragmentShader:`in vec3 at; in vec3 tone; out vec4 result; void main() { ${sh} result = vec4(tone * (0.72 + 0.33 * lit), 1.0); }`}),o=new Ee(s,r);o.frustumCulled=!1,this.marks.add(o)}setStress(t){this.stressed&&this.stressed!==t&&(this.group.remove(this.stressed.group),this.stressed.dispose()),this.stressed=t,t&&this.group.add(t.group),this.showStress(t!==null)}showStress(t){this.stressed&&(this.stressed.group.visible=t),this.mesh.visible=this.borders.visible=!t||!this.stressed}get stress(){return this.stressed}get isStressShown(){return this.stressed!==null&&this.stressed.group.visible}dispose(){this.setStress(null),this.setArrows([]),this.setBranches(null),this.colours.dispose();for(let t of[this.mesh,this.borders,...this.faults])t.geometry.dispose(),t.material.dispose()}};function Hg(i){let t=new Map,e=o=>{let a=o;for(;t.get(a)!==a;){let l=t.get(a);t.set(a,t.get(l)),a=t.get(a)}return a},n=o=>`${i[3*o]} ${i[3*o+1]} ${i[3*o+2]}`,s=i.length/6;for(let o=0;o<s;o++){let[a,l]=[n(2*o),n(2*o+1)];for(let c of[a,l])t.has(c)||t.set(c,c);t.set(e(a),e(l))}let r=new Map;for(let o=0;o<2*s;o++){let a=e(n(o)),l=r.get(a)??[new C,0];l[0].add(new C().fromArray(i,3*o)),l[1]++,r.set(a,l)}return[...r.values()].map(([o,a])=>o.divideScalar(a))}function Yg(i,t,e,n){let s=new ki;s.setAttribute("position",new Ht(new Float32Array([0,1,0,0,-1,0,1,1,0,1,-1,0]),3)),s.setIndex([0,1,2,2,1,3]);let r=new zi(i,8);s.setAttribute("a",new xn(r,4,0)),s.setAttribute("b",new xn(r,4,4)),s.instanceCount=i.length/8;let o=new St,a=new Ee(s,new Ie({glslVersion:Cn,vertexShader:cM,fragmentShader:e,side:Te,uniforms:{...n,pixels:{value:o},wide:{value:t}}}));return a.onBeforeRender=l=>{l.getSize(o)},a.frustumCulled=!1,a}function Wg(i,t,e,n){let s=new Float32Array(4*i.length/3);for(let o=0;3*o<i.length;o++)s.set(i.subarray(3*o,3*o+3),4*o);let r=Yg(s,t,`out vec4 result; void main() { result = vec4(${e.join(".0, ")}.0, 255.0) / 255.0; }`,{});return[r.material.polygonOffset,r.material.polygonOffsetFactor,r.material.polygonOffsetUnits]=[!0,-1-n,-1-n],r.renderOrder=n,r.visible=i.length>0,r}function mM(i,t,e){let n=new Me;n.setAttribute("position",new Ht(i,3));let s=new as(n,new Ni({color:t,transparent:e<1,opacity:e}));return s.frustumCulled=!1,s}function ch(i,t){i.translate(0,t,0);let e=i.toNonIndexed().getAttribute("position").array;return i.dispose(),e}var $g=ch(new Oi(.028,.028,.76,10,1),.38),Xg=ch(new Bi(.085,.26,14,1),.87),gM=ch(new Bi(.085,.26,14,1),.66),_M=ch(new Bi(.4,1,12,1),-.5);var Gd=["x","y","z"],hh=class{constructor(t,e,n,s,r){this.view=t;this.job=e;this.low=n;this.high=s;this.parts=r}view;job;low;high;parts;axis=-1;at=0;isLowKept=!0;ofCase=0;hasPoints=!1;pointWords=S("output",{id:"degenerate-count"});isBusy=!1;isStale=!1;fields(){let t=()=>[this.low.getComponent(this.axis),this.high.getComponent(this.axis)],e=S("input",{type:"range",id:"section-slider",step:"any","aria-label":"Place of the section",oninput:()=>o(e.valueAsNumber)}),n=An({id:"section-at"},{isView:!0},u=>o(u)),s=S("input",{type:"checkbox",id:"section-other",onchange:()=>{this.isLowKept=!this.isLowKept,this.section()}}),r=S("div",{hidden:!0},S("div",{class:"row"},e,S("label",{},"at, mm",n)),S("label",{for:"section-other",class:"check"},s," the other half")),o=u=>{this.at=u,ti(n,Number(u.toFixed(3))),e.value=String(u),this.section()},a=S("select",{id:"section",onchange:()=>{if(this.axis=Number(a.value),r.hidden=this.axis<0,this.axis<0){this.section();return}let[u,d]=t();[e.min,e.max]=[String(u),String(d)],e.step=String((d-u)/100);let f=this.parts.viewer();this.isLowKept=!f||f.camera.position.getComponent(this.axis)>=f.controls.target.getComponent(this.axis),s.checked=!1,o(.5*(u+d))}},S("option",{value:-1},"none"),...Gd.map((u,d)=>S("option",{value:d},`across ${u}`))),l=S("input",{type:"checkbox",id:"lines",onchange:()=>{this.lines(l.checked)}}),c=S("input",{type:"checkbox",id:"degenerate",onchange:()=>{this.hasPoints=c.checked,this.points()}}),h=u=>{let d=S("span",{class:"swatch"});return d.style.background=wi(u),d};return[S("div",{class:"row"},S("label",{},"Section",a)),r,S("label",{for:"lines",class:"check"},l," principal stress lines"),S("p",{class:"note"},h(Fd),"tension ",h(Ud),"compression along the line"),S("label",{for:"degenerate",class:"check"},c," degenerate points of the surface ",this.pointWords),S("p",{class:"note"},"where both principal stresses in the surface are equal: ",h(kd),"wedge ",h(zd),"trisector")]}setCase(t){this.ofCase=t,this.section(),this.view.hasLines&&this.lines(!0),this.points()}points(){let t=this.view.setDegenerate(this.hasPoints?this.view.misesEnd:null);this.pointWords.textContent=this.hasPoints?`(${t.length})`:"",this.parts.viewer()?.draw()}section(){if(this.isBusy){this.isStale=!0;return}this.fetchSection()}async fetchSection(){this.isBusy=!0;do{this.isStale=!1;let{axis:t,at:e,isLowKept:n}=this;try{let s=t<0?null:await cn(`v1/jobs/${this.job}/stress/${this.ofCase}/section?axis=${Gd[t]}&at=${e}`);this.view.setSection(s,t,e,n),document.documentElement.dataset.section=t<0?"none":`${Gd[t]} ${e} ${n}`}catch(s){this.parts.say(s.message,!0)}this.parts.viewer()?.draw()}while(this.isStale);this.isBusy=!1}async lines(t){try{this.view.setLines(t?await cn(`v1/jobs/${this.job}/stress/${this.ofCase}/lines`):null),t&&!this.view.hasLines&&this.parts.say("No stress in this part is clear enough for a line."),document.documentElement.dataset.lines=String(t)}catch(e){this.parts.say(e.message,!0)}this.parts.viewer()?.draw()}};var uh=class{constructor(t){this.parts=t}parts;element=S("div",{id:"poses"});all=null;warnings=[];of="";show(t,e){e!==this.of&&([this.all,this.of]=[null,e]);let n=S("button",{type:"button",id:"compare-poses",onclick:()=>{this.compare(t)}},"Compare build directions");if(!this.all){this.element.replaceChildren(S("div",{class:"row"},n));return}let s=this.all.some(a=>a.reserve),r=(a,l)=>{let c=a.rotate_deg.every((_,m)=>Math.abs(_-(t[m]??0))<.001),h=`turned by ${a.rotate_deg.map(_=>nt(_,1)).join(", ")} degrees`,u=_=>S("td",{class:"n"},_),[d,f,p]=a.reserve?.first_failure??[];return S("tr",c?{"aria-current":"true"}:{},S("td",{},S("button",{type:"button","data-pose":l,disabled:c,title:h,"aria-label":`${c?"Stands so":"Take"}: ${h}`,onclick:()=>this.parts.stand(a.rotate_deg)},c?"stands":"take")),u(`${nt(a.height_mm,1)} mm`),u(`${nt(a.support_g,2)} g`),u(ji(a.time_s)),...s?[u(a.reserve?`${nt(a.reserve.across_layers_mpa,2)} MPa`:"–"),S("td",{class:"n",title:d===void 0?"":`${nt(d,2)} to ${nt(p,2)}, ${a.reserve.mode}`},f===void 0?"–":`${nt(f,2)} ×`)]:[])},o=["","Height","Support","Time",...s?["Across","Fails at"]:[]];this.element.replaceChildren(S("div",{class:"wide"},S("table",{},S("tr",{},...o.map(a=>S("th",{scope:"col"},a||S("span",{class:"sr"},"Choose")))),...this.all.map(r))),S("p",{class:"note"},s?"The best first: by the factor on the loads at which the first bead or bond fails, then by support, height and time. Across is the tension from layer to layer. Loads turn with the part.":"The best first: by support, height and time. With fixtures and loads, what they do to the layers counts before that."),...this.warnings.map(Yn),S("div",{class:"row"},n))}async compare(t){let e=this.parts.wanted(),{of:n}=this,s=e&&await this.parts.run({kind:"orient",...e});if(!(!s||n!==this.of))try{let r=await In(s.id);this.all=r.report.poses,this.warnings=r.warnings,this.show(t,n),document.documentElement.dataset.poses=String(s.id)}catch(r){this.parts.say(r.message,!0)}}};var yM=[["none","none"],["tree","trees"],["columns","columns"],["box","boxes"]],Hd={enforce:"enforce_facets",block:"block_facets"},dh=class{constructor(t){this.parts=t}parts;element=S("div",{id:"supports"});paint=null;isActive=!0;facets={enforce:new Set,block:new Set};told=S("div",{role:"status"});counts=S("p",{class:"note",id:"support-facets"});grown=null;get text(){return this.parts.job.text()??""}build(){this.setPaint(null),this.grown=null,this.told.replaceChildren();let t=S("select",{id:"support-style",onchange:()=>this.parts.job.put(ge(this.text,"support","style",t.value==="none"?null:Fe(t.value)))},...yM.map(([r,o])=>S("option",{value:r},o))),e=r=>{let o=S("span",{class:"swatch"});return o.style.background=wi(r),o},n=(r,o,a,l)=>S("button",{type:"button",id:`paint-${r}`,"aria-pressed":"false",title:l,onclick:()=>this.setPaint(this.paint===r?null:r)},...a?[e(a)]:[],o),s=(r,o)=>S("button",{type:"button",id:`faces-${r}`,onclick:()=>this.faces(r)},o);this.element.replaceChildren(S("div",{class:"row"},S("label",{},"below overhangs",t),S("button",{type:"button",id:"grow-supports",onclick:()=>{this.grow()}},"Show the supports")),S("div",{class:"row",id:"paints"},n("enforce","Paint: support",Dd,"Drag over facets that are always held, whatever their angle"),n("block","Paint: none",Nd,"Drag over facets that are never held"),n("erase","Erase",null,"Drag over facets whose angle decides again")),S("div",{class:"row"},s("enforce","Support the chosen faces"),s("block","Never below them"),s("erase","As the angle says")),this.counts,this.told),this.textChanged(),this.chosenChanged()}textChanged(){let t=this.parts.view();if(!t)return;let e=document.getElementById("support-style");e&&(e.value=String(Qe(re(this.text,"support","style")??'"none"')??"none"));let n=s=>{let r=Qe(re(this.text,"support",s)??"");return new Set(Array.isArray(r)?r.filter(o=>typeof o=="number"):[])};this.facets={enforce:n(Hd.enforce),block:n(Hd.block)},this.grown&&(this.grown.of!==t||this.grown.text!==this.supportsOf())&&this.hide(),this.show()}chosenChanged(){for(let t of["enforce","block","erase"]){let e=document.getElementById(`faces-${t}`);e&&(e.disabled=this.parts.chosen().length===0)}}supportsOf(){let t=this.text;return Ai(t).filter(e=>["support","process","material"].includes(e.table)).map(e=>`${e.table}.${e.key}=${t.slice(e.from,e.to)}`).join(`
`)}show(){let{enforce:t,block:e}=this.facets;this.parts.view()?.setPainted(t,e),this.counts.textContent=t.size+e.size===0?"No facet is painted: the angle of the surface decides where supports are needed.":`Painted: ${t.size} facets are held, ${e.size} are left free.`,this.parts.viewer()?.draw()}setActive(t){this.isActive=t,t||this.setPaint(null),this.parts.view()?.showBranches(t)}setPaint(t){this.paint=t,this.parts.viewer()?.setGesture(t?"paint":"turn");for(let e of["enforce","block","erase"])document.getElementById(`paint-${e}`)?.setAttribute("aria-pressed",String(t===e))}stroke(t){this.paint&&(this.take(t,this.paint),this.show())}strokeEnd(){this.paint&&this.put()}faces(t){let e=this.parts.view();if(e){for(let n of this.parts.chosen())this.take([...e.triangles(n)],t);this.put()}}take(t,e){for(let n of t)for(let s of["enforce","block"])s===e?this.facets[s].add(n):this.facets[s].delete(n)}put(){let t=this.text;for(let e of["enforce","block"]){let n=[...this.facets[e]].sort((s,r)=>s-r);t=ge(t,"support",Hd[e],n.length>0?`[${n.join(", ")}]`:null)}this.facets.enforce.size>0&&re(t,"support","style")===null&&(t=ge(t,"support","style",Fe("tree"))),this.parts.job.put(t),this.show()}hide(){this.grown=null,this.parts.view()?.setBranches(null),this.told.replaceChildren(S("p",{class:"note"},"The job has changed: show the supports again."))}async grow(){let[t,e,n]=[this.parts.job.wanted(),this.parts.view(),this.supportsOf()],s=t&&e&&await this.parts.run({kind:"supports",...t});if(!(!s||this.parts.view()!==e))try{let[r,o]=await Promise.all([In(s.id),cn(`v1/jobs/${s.id}/branches`)]),a=r.report.support,l=new Float32Array(o),c=e.setBranches(l);this.grown={of:e,text:n};let h=(f,p,_="")=>S("tr",{},S("td",{},f),S("td",{class:"n",..._?{id:_}:{}},p)),u=S("div",{class:"ramp"});u.style.background=Ki(Ln);let d=a.unreached.length;this.told.replaceChildren(a.contacts===0?S("p",{class:"note"},"Nothing needs support."):S("div",{class:"legend"},S("div",{},"Load of a branch"),u,S("div",{class:"ends"},S("span",{},"0 N"),S("span",{},`${nt(c,2)} N`))),S("table",{},h("Mass",`${nt(a.mass_g??a.solid_mass_g,2)} g`,"support-mass"),h("Contacts, trees",`${a.contacts}, ${a.trees}`,"support-contacts"),h("Farthest from a contact",`${nt(a.farthest_mm,1)} mm`),...d>0?[h("Overhangs that no branch reaches",String(d))]:[]),...r.warnings.map(Yn)),this.parts.viewer()?.draw(),document.documentElement.dataset.supports=String(s.id)}catch(r){this.parts.say(r.message,!0)}}wordsAt(t){let e=this.parts.viewer(),n=this.isActive&&this.grown&&e&&t.clientX>=0?this.parts.view()?.branchAt(e.rayAt(t.clientX,t.clientY)):null;if(!n)return null;let{load_n:s,isContact:r,at:o}=n;return`${r?"contact":"branch"} that bears ${nt(s,2)} N · at (${o.toArray().map(a=>nt(a,1)).join(", ")})`}};var xM=250,vM=["mm","cm","m","inch","micron","foot"],bM=[["guide","frame"],["support","style"],["support","lift_mm"]],ia=class i{constructor(t,e){this.panel=t;this.parts=e;this.poses=new uh({run:e.run,say:e.say,wanted:()=>e.job.wanted(),stand:n=>this.stand(n)}),this.supports=new dh({...e,view:()=>this.view,chosen:()=>this.chosen}),this.close()}panel;parts;report=null;view=null;chosen=[];side=null;onPart=()=>{};onChosen=()=>{};key="";warnings=[];timer=0;asked=new AbortController;poses;supports;close(){[this.report,this.view,this.chosen,this.side,this.key]=[null,null,[],null,""],clearTimeout(this.timer),this.asked.abort(),this.parts.viewer()?.setPart(null),this.panel.replaceChildren(S("p",{class:"note"},"Open a mesh (STL, OBJ, PLY, OFF, 3MF), a drawing (SVG, DXF), a scan or a job file to see its shape here, choose faces, and say where it is held and loaded.")),this.onPart()}static has(t){return["mesh","outline","ct"].some(e=>re(t,"shape",e)!==null)||re(t,"shape.ct","path")!==null}textChanged(t){i.has(t)&&(clearTimeout(this.timer),this.report&&this.supports.textChanged(),this.keyOf(t)!==this.key&&(this.timer=setTimeout(()=>{this.load()},xM)))}keyOf(t){return Ai(t).filter(n=>n.table==="shape"||n.table.startsWith("shape.")||bM.some(([s,r])=>s===n.table&&r===n.key)).map(n=>`${n.table}.${n.key}=${t.slice(n.from,n.to)}`).join(`
`)}async load(){let t=this.parts.job.wanted(),e=this.parts.job.text();if(!t||e===null)return;this.asked.abort();let{signal:n}=this.asked=new AbortController;clearTimeout(this.timer),this.key=this.keyOf(e);let s=await this.parts.run({kind:"shape",...t},n);if(!s||n.aborted)return;let[r,o]=await Promise.all([In(s.id),cn(`v1/jobs/${s.id}/surface`)]);if(n.aborted)return;let a=this.report!==null;this.report=r.report,this.warnings=r.warnings,this.chosen=this.chosen.filter(h=>h<this.report.faces_in_all),this.side=null;let l=new ah(qg(o),()=>{document.documentElement.dataset.search=String(s.id)});this.view=l;let c=this.parts.viewer();c&&c.setPart(l,a),this.build(),this.onPart(),document.documentElement.dataset.shape=String(s.id)}choose(t,e){this.side=null,t<0?e||(this.chosen=[]):e?this.chosen=this.chosen.includes(t)?this.chosen.filter(n=>n!==t):[...this.chosen,t]:this.chosen=this.chosen.length===1&&this.chosen[0]===t?[]:[t],this.onChosen()}add(t){let e=t.filter(n=>!this.chosen.includes(n));e.length!==0&&(this.side=null,this.chosen=[...this.chosen,...e],this.onChosen())}grow(t){this.view&&this.add(this.view.beside(this.chosen,t))}words(t){let e=this.report?.faces[t];if(!e)return"a face without a name: too many smaller ones";let n=e.radius_mm?`, ${e.hollow?"hole of radius":"radius"} ${nt(e.radius_mm,2)} mm`:"";return`${e.name} · ${e.kind}${n}, ${nt(e.area_mm2,1)} mm²${e.doubtful?" · another face is alike: choose it by a box in the text":""}`}put(t,e){let n=this.parts.job.text();n!==null&&this.parts.job.put(ge(n,"shape",t,e))}build(){let t=this.report,e=[0,1,2].map(f=>t.high_mm[f]-t.low_mm[f]),n=this.warnings.map(Yn),s=(f,p,_="")=>S("tr",{},S("td",{},f),S("td",{class:"n",..._?{id:_}:{}},p)),r=[s("Size",`${e.map(f=>nt(f,2)).join(" × ")} mm`,"size"),s("Volume",`${nt(t.volume_mm3/1e3,3)} cm³`)];if(t.preview){let{resolution_mm:f,voxels:p,merged:_}=t.preview,m=_.reduce((g,y)=>g*y,1);this.panel.replaceChildren(S("h2",{},"Size"),S("table",{},...r,s("Voxels",p.join(" × "))),S("p",{class:"note",id:"preview"},`A preview at ${nt(f,2)} mm: ${m===1?"no voxels were merged":`${_.join(" × ")} voxels were merged into one`}. Paths are planned from every voxel, under Job.`),...n);return}let a=[[t.open_edges,"open edges"],[t.nonmanifold_edges,"edges with more than two triangles"],[t.badly_wound_edges,"edges of triangles wound against each other"],[t.zero_area_facets,"triangles without area"]].filter(([f])=>f>0),l=S("select",{id:"unit",onchange:()=>this.put("unit",Fe(l.value))},...vM.map(f=>S("option",{value:f,selected:f===t.unit},f))),c=An({id:"scale",value:t.scale},{isPositive:!0},f=>this.put("scale",String(f))),h=t.likely_unit!==null&&t.likely_unit!==t.unit,u=f=>S("button",{type:"button",id:`turn-${"xyz"[f]}`,onclick:()=>this.turn(new Oe().setFromAxisAngle(new C().setComponent(f,1),Math.PI/2))},`90° about ${"xyz"[f]}`),d=S("button",{type:"button",id:"lay",onclick:()=>this.lay()},"Lay the chosen face on the plate");this.panel.replaceChildren(S("h2",{},"Size"),S("table",{},...r,s("Bodies, shells",`${t.bodies}, ${t.shells}`),s("Triangles",String(t.triangles)),s("Faces",String(t.faces_in_all),"faces-in-all")),...h?[S("p",{class:"warning",id:"unit-asked"},`The file states no unit. In mm the part would be ${nt(Math.max(...e),2)} mm long, which is small: is it in ${t.likely_unit}? `,S("button",{type:"button",id:"take-likely",onclick:()=>this.put("unit",Fe(t.likely_unit))},`It is in ${t.likely_unit}`)," ",S("button",{type:"button",onclick:()=>this.put("unit",Fe("mm"))},"It is in mm"))]:[],S("div",{class:"row"},S("label",{},t.unit_is_stated?"Unit":"Unit (the file states none)",l),S("label",{},"Scale",c)),S("h2",{},"Defects"),a.length===0?S("p",{class:"note",id:"defects"},"None: the surface is closed."):S("table",{id:"defects"},...a.map(([f,p])=>s(p,String(f)))),...this.defects(t),...n,S("h2",{},"Turn"),S("div",{class:"row"},u(0),u(1),u(2)),S("div",{class:"row"},d),S("p",{class:"note"},"Choose a face by a click on the part, or in the list of the next tab."),S("h2",{},"Build direction"),this.poses.element,S("h2",{},"Supports"),this.supports.element,S("h2",{},"Place on the plate"),this.place(),S("div",{class:"row"},S("button",{type:"button",class:"main",onclick:()=>this.parts.openLoads()},"Say where it is held and loaded"))),this.supports.build(),this.chosenChanged()}defects(t){if(t.open_edges+t.nonmanifold_edges+t.badly_wound_edges===0)return[];let e=l=>{let c=S("span",{class:"swatch"});return c.style.background=wi(l),c},n=this.view?.defects()??[],s=0,r=S("output",{id:"defect"}),o=S("button",{type:"button",id:"next-defect",onclick:()=>{let[l,c]=[n[s%n.length],this.parts.viewer()];!l||!c||!this.view||(c.lookAt(l,.12*this.view.high.distanceTo(this.view.low)),r.textContent=`${s%n.length+1} of ${n.length}, at (${l.toArray().map(h=>nt(h,1)).join(", ")})`,s++)}},"Look at the next one"),a=t.edges_left===0?"all of them were mended":`${t.edges_left} edges are left after mending`;return[S("p",{class:"note"},"On the part: ",e(Od),"in the file ",e(Bd),`left after mending; ${a}.`),...n.length>0?[S("div",{class:"row"},o,r)]:[]]}get rotation(){let t=Qe(re(this.parts.job.text()??"","shape","rotate_deg")??"");return Array.isArray(t)&&t.every(e=>typeof e=="number")?t:[0,0,0]}showPoses(t){if(!this.report)return;let e=this.parts.job.text()??"",n=["shape.rotate_deg","shape.position_mm"],s=r=>r.table==="shape"&&!n.includes(`shape.${r.key}`)||r.table.startsWith("support")||r.table==="process"||r.table==="material"||r.table.startsWith("fill")&&r.key!=="density";this.poses.show(this.rotation,Ai(e).filter(s).map(r=>`${r.table}.${r.key}=${e.slice(r.from,r.to)}`).join(`
`)+t)}stand(t){let e=this.parts.turning();if("refused"in e){this.parts.say(e.refused,!0);return}this.parts.job.put(ge(e.text,"shape","rotate_deg",`[${t.map(Vs).join(", ")}]`))}place(){let t=Qe(re(this.parts.job.text()??"","shape","position_mm")??""),e=Array.isArray(t)?t:[],n=["x","y"].map((r,o)=>An({id:`place-${r}`,placeholder:"middle",value:typeof e[o]=="number"?e[o]:""},{isOptional:!0},()=>s())),s=()=>{let r=n.map(va),o=n.every(a=>a.value==="");n.forEach((a,l)=>Es(a,Number.isFinite(r[l])||o?"":"needs a number too, or neither")),(o||r.every(Number.isFinite))&&this.put("position_mm",o?null:`[${r.join(", ")}]`)};return S("div",{class:"row"},...n.map((r,o)=>S("label",{},`middle on the plate, ${"xy"[o]}, mm`,r)))}chosenChanged(){let t=document.getElementById("lay");t&&(t.disabled=this.chosen.length!==1),this.supports.chosenChanged()}lay(){let t=this.chosen[0],e=t===void 0?null:this.view?.patch(t).normal;e&&e.length()>.5&&this.turn(new Oe().setFromUnitVectors(e,new C(0,0,-1)))}turn(t){let[e,n,s]=this.report.rotation,r=new Pt().set(e[0],e[1],e[2],0,n[0],n[1],n[2],0,s[0],s[1],s[2],0,0,0,0,1),o=new Pt().makeRotationFromQuaternion(t).multiply(r).elements;this.stand(SM((a,l)=>o[4*l+a]))}};function SM(i){let t=180/Math.PI,e=Math.asin(Math.min(Math.max(-i(2,0),-1),1));return Math.abs(i(2,0))>1-1e-9?[Math.atan2(-i(1,2),i(1,1))*t,e*t,0]:[Math.atan2(i(2,1),i(2,2))*t,e*t,Math.atan2(i(1,0),i(0,0))*t]}var Vs=i=>String(Math.round(i*1e5)/1e5+0);var fh=[["force_n","force, N",!0],["pressure_mpa","pressure, MPa",!1],["moment_nmm","moment, N mm",!0],["torque_nmm","torque about the axis of the face, N mm",!1],["bearing_n","bearing load of a pin, N",!0],["acceleration_mm_s2","acceleration, mm/s²",!0]],Zg=[["xyz","in all directions"],["normal","across the surface (it may slide)"],["x","along x"],["y","along y"],["z","along z"],["xy","along x and y"],["xz","along x and z"],["yz","along y and z"]],MM=-9806.65,Sn=i=>Array.isArray(i)&&i.length===3&&i.every(t=>typeof t=="number")?i:null,ph=class{constructor(t,e){this.panel=t;this.parts=e;this.partChanged()}panel;parts;items=[];cases=[];stress=null;shown={what:"mises",case:0,scale:null,magnified:0,isOn:!0};list=S("div",{id:"items"});picked=S("div",{id:"picked"});answer=S("div",{id:"stress"});isActive=!1;drawn="";setActive(t){this.isActive=t,t||this.setGesture("turn"),this.legend()}get text(){return this.parts.job.text()??""}put(t){this.parts.job.put(t)}partChanged(){let{report:t}=this.parts.shape;if(this.stress=null,this.answer.replaceChildren(),!t){this.panel.replaceChildren(S("p",{class:"note"},"Open a mesh, a drawing or a job file to say where its part is held and loaded.")),this.legend();return}let e=t.faces.map((s,r)=>{let o=S("button",{type:"button",class:"face","data-face":r,"aria-pressed":"false",onclick:a=>this.parts.shape.choose(r,a.shiftKey||a.ctrlKey)},this.parts.shape.words(r));for(let[a,l]of[["focus",r],["pointerenter",r],["blur",-1],["pointerleave",-1]])o.addEventListener(a,()=>this.parts.viewer()?.setHovered(l));return S("li",{},o)}),n=t.preview!==void 0;this.panel.replaceChildren(...n?[S("p",{class:"note"},"A scan has no faces: places are boxes and planes, written in the text of the job.")]:[S("h2",{},"Chosen faces"),this.tools(),this.picked,S("details",{id:"all-faces"},S("summary",{},`All faces (${t.faces_in_all})`),S("ul",{class:"plain faces"},...e),...t.faces_in_all>t.faces.length?[S("p",{class:"note"},`${t.faces_in_all-t.faces.length} smaller ones are not listed.`)]:[])],S("h2",{},"Fixtures and loads"),this.list,...n?[]:[S("h2",{},"Stress"),S("div",{class:"row"},S("button",{type:"button",class:"main",id:"solve",onclick:()=>{this.solve()}},"Solve the stress")),this.answer],S("h2",{},"Next"),this.followBox(),S("div",{class:"row"},S("button",{type:"button",id:"plan-here",onclick:()=>{this.parts.job.plan()}},"Plan the paths"),S("button",{type:"button",id:"test-here",onclick:()=>this.parts.test()},"Where does it break?"))),this.drawn="",this.textChanged(),this.chosenChanged()}tools(){let t=(n,s,r)=>S("button",{type:"button",id:n,"aria-pressed":"false",title:r,onclick:()=>this.setGesture(this.parts.viewer()?.dragging===n?"turn":n)},s),e=(n,s,r,o)=>S("button",{type:"button",id:n,disabled:!0,title:o,onclick:()=>this.parts.shape.grow(s)},r);return S("div",{class:"row",id:"tools"},t("box","Box","Drag a box around faces (or hold R and drag)"),t("brush","Brush","Drag over faces (or hold B and drag)"),S("button",{type:"button",id:"split","aria-pressed":"false",disabled:!0,title:"Cut the chosen face along a line: click two points of it",onclick:()=>this.beginSplit()},"Split"),e("grow",!0,"Grow","Add the neighbours over smooth edges (G)"),e("grow-all",!1,"All neighbours","Add all neighbours (Shift+G)"))}setGesture(t){this.parts.viewer()?.setGesture(t),t!=="split"&&(this.splitFrom=null);for(let e of["box","brush","split"])document.getElementById(e)?.setAttribute("aria-pressed",String(t===e))}splitFrom=null;beginSplit(){if(this.parts.viewer()?.dragging==="split"){this.setGesture("turn");return}this.setGesture("split"),this.parts.say("Click two points of the chosen face: it is cut along the line through them.")}split(t){let{shape:e}=this.parts,n=this.parts.viewer()&&e.view?.pointAt(this.parts.viewer().rayAt(t.clientX,t.clientY));if(!n||n.face!==e.chosen[0]){this.parts.say("That point lies on another face; click the chosen one.",!0);return}if(!this.splitFrom){this.splitFrom=n.point,this.parts.say("Now the second point.");return}let s=n.normal.clone().cross(n.point.clone().sub(this.splitFrom));if(s.length()<1e-6){this.parts.say("The two points are one; click another place.",!0);return}e.side={point:this.splitFrom,normal:s.normalize()},this.setGesture("turn"),document.getElementById("progress").hidden=!0,this.chosenChanged()}sideOf(t){let e=t&&typeof t=="object"&&!Array.isArray(t)?t:null,[n,s]=[Sn(e?.point_mm),Sn(e?.normal)];return n&&s?{point:this.pointToPart(new C().fromArray(n)),normal:this.toPart(new C().fromArray(s)).normalize()}:null}onFace(t,e,n=this.parts.shape.report.frame_is_part){if(!e)return`{ face = ${Fe(t)} }`;let[s,r]=[e.point.clone(),e.normal.clone()];if(n){let{report:o}=this.parts.shape,a=this.rotation.transpose();s.sub(new C().fromArray(o.shift_mm)).applyMatrix4(a).divideScalar(o.scale),r.applyMatrix4(a)}return`{ face = ${Fe(t)}, side = { point_mm = ${Hr(s.toArray())}, normal = ${Hr(r.toArray())} } }`}followBox(){let t=S("input",{type:"checkbox",id:"follow",onchange:()=>{let e=ge(this.text,"guide","kind",t.checked?Fe("stress"):null);e=ge(e,"fill","pattern",t.checked?Fe("stripes"):null),this.put(e)}});return S("label",{for:"follow",class:"check"},t," lay the fill along the stress (stripes)")}textChanged(){if(!this.parts.shape.report)return;this.items=this.read();let t=JSON.stringify([this.items.map(n=>[n.name,n.place,n.block!==null,Object.keys(n.keys)]),this.cases.map(n=>n.name)]);if(t===this.drawn)this.fill();else{let n=document.activeElement?.id??"";this.list.replaceChildren(...this.rows()),n&&this.list.querySelector(`#${CSS.escape(n)}`)&&document.getElementById(n)?.focus()}this.drawn=t;let e=document.getElementById("follow");if(e&&(e.checked=re(this.text,"guide","kind")==='"stress"'),this.stress&&this.stress.text!==this.loadsOf(this.text)){let n=document.getElementById("stale");n&&(n.hidden=!1)}this.draw()}fill(){this.items.forEach((t,e)=>{let n=(s,r)=>{let o=document.getElementById(s);!o||r===void 0||o===document.activeElement||ti(o,r)};n(`fix-${e}`,t.keys.fix);for(let[s,,r]of fh){let o=t.keys[s];r?Sn(o)?.forEach((a,l)=>n(`value-${e}-${"xyz"[l]}`,a)):n(`value-${e}`,o)}Sn(t.keys.displacement_mm)?.forEach((s,r)=>n(`moved-${e}-${"xyz"[r]}`,s))}),this.cases.forEach((t,e)=>{let n=document.getElementById(`weight-${e}`);n&&n!==document.activeElement&&ti(n,this.weight(e))})}loadsOf(t){return JSON.stringify([this.items.map(e=>[e.name,e.keys,e.case]),this.cases.map((e,n)=>this.weight(n)),["analysis","element_mm","frame","elasticity"].map(e=>re(t,"guide",e)),re(t,"material","profile")])}read(){let t=this.text,e=new Map(this.parts.shape.report.faces.map((a,l)=>[a.name,l])),n=[],s="";this.cases=[];let r=new Map,o=(a,l,c,h)=>{let u=`${a} ${h}`,d=(r.get(u)??0)+1;r.set(u,d);let f=c.on,p=f&&typeof f=="object"&&!Array.isArray(f)?f.face:void 0,_=typeof p=="string"?e.get(p)??-1:-1,m=_>=0?this.sideOf(f.side):null,g=_>=0?`${this.parts.shape.words(_)}${m?` · the part beyond ${wM(f.side)}`:""}`:f?JSON.stringify(f).replaceAll('"',""):"the whole part";n.push({name:`${a?"fixture":"load"} ${d}${h===null?"":` of case ${h}`}`,isFixture:a,block:l,case:h,keys:c,face:_,side:m,place:g})};for(let a of Qi(t,"guide.fixture","guide.load","guide.case","guide.case.load")){let l={};for(let[c,h]of a.keys){let u=Qe(t.slice(h.from,h.to));u!==void 0&&(l[c]=u)}if(a.table==="guide.case"){s=String(l.name??""),this.cases.push({name:s,block:a});continue}o(a.table==="guide.fixture",a.isPlain?a:null,l,a.table==="guide.case.load"?s:null)}for(let a of["fixture","load"]){let l=Qe(re(t,"guide",a)??"");if(Array.isArray(l))for(let c of l)c&&typeof c=="object"&&!Array.isArray(c)&&o(a==="fixture",null,c,null)}return n}rows(){return this.items.length===0?[S("p",{class:"note"},"None yet. Choose a face on the part, then press Hold here or Load here.")]:[...this.items.map((t,e)=>this.row(t,e)),...this.caseRows()]}weight(t){let e=this.cases[t]?.block.keys.get("weight"),n=e&&Qe(this.text.slice(e.from,e.to));return typeof n=="number"?n:1}caseRows(){return this.cases.length===0?[]:[S("h3",{},"Load cases"),...this.cases.map(({name:t},e)=>{let n=An({id:`weight-${e}`,value:this.weight(e)},{isPositive:!0},s=>this.put(eo(this.text,this.cases[e].block,"weight",String(s))));return S("div",{class:"row"},S("label",{},`${t}: weight`,n))}),S("p",{class:"note"},"Loads of one case act together. Cases act one after the other, each with the same fixtures; loads without a case form one more.")]}moveTo(t,e){if(!t.block)return;let n=this.text.slice(t.block.from,t.block.to).replace(/^[^\n]*\n/,""),s=this.without(t);if(e===null){let r=Qi(s,"guide.fixture","guide.load");s=Ys(s,r.length>0?r[r.length-1].to:s.length,`[[guide.load]]
${n}`)}else{let r=Qi(s,"guide.case","guide.case.load"),o=u=>{let d=u.keys.get("name");return u.table==="guide.case"&&d!==void 0&&Qe(s.slice(d.from,d.to))===e},a=r.findIndex(o),l=a<0;if(l)a=r.length-1;else for(;r[a+1]?.table==="guide.case.load";)a++;let c=l?`[[guide.case]]
name = ${Fe(e)}
weight = 1

`:"",h=[...Qi(s,"guide.fixture","guide.load")].pop();s=Ys(s,a>=0?r[a].to:h?.to??s.length,`${c}[[guide.case.load]]
${n}`)}this.put(s)}without(t){let e=Bh(this.text,t.block);if(t.case===null||this.items.some(s=>s!==t&&s.case===t.case))return e;let n=Qi(e,"guide.case").find(s=>{let r=s.keys.get("name");return r!==void 0&&Qe(e.slice(r.from,r.to))===t.case});return n?Bh(e,n):e}newCase(){for(let t=this.cases.length+1;;t++)if(!this.cases.some(e=>e.name===`case ${t}`))return`case ${t}`}row(t,e){let n=()=>this.items[e]?.block??null,s=(p,_)=>{let m=n();m&&this.put(eo(this.text,m,p,_))},r=S("button",{type:"button",id:`remove-${e}`,"aria-label":`Remove ${t.name}`,onclick:()=>{let p=this.items[e];p?.block&&this.put(this.without(p))}},"Remove"),o=S("fieldset",{class:t.isFixture?"held":"loaded"},S("legend",{},t.name));for(let[p,_]of[["pointerenter",t.face],["focusin",t.face],["pointerleave",-1],["focusout",-1]])o.addEventListener(p,()=>this.parts.viewer()?.setHovered(_));if(o.append(S("p",{class:"note"},t.place)),!t.block)return o.append(S("p",{class:"note"},"It is changed in the text of the job.")),o;if(t.isFixture){let p=String(t.keys.fix??""),_=S("select",{id:`fix-${e}`,onchange:()=>s("fix",Fe(_.value))},...Zg.map(([g,y])=>S("option",{value:g,selected:g===p},y)));Zg.some(([g])=>g===p)||_.append(S("option",{value:p,selected:!0},p));let m=Sn(t.keys.displacement_mm);return o.append(S("div",{class:"row"},S("label",{},"held",_),r),S("details",m?{open:!0}:{},S("summary",{},"moved by a given way"),this.vector(`moved-${e}`,"mm",()=>Sn(this.items[e]?.keys.displacement_mm)??[0,0,0],g=>s("displacement_mm",g.every(y=>y===0)?null:`[${g.join(", ")}]`)))),o}let a=fh.find(([p])=>p in t.keys);if(!a)return o.append(S("p",{class:"note"},"Its kind is changed in the text of the job."),r),o;let l="on"in t.keys,c=S("select",{id:`kind-${e}`,onchange:()=>{let[p,{text:_}]=[c.value,this],m=n()?.keys.get(a[0]);if(!m)return;let g=_.lastIndexOf(`
`,m.from)+1,y=[a[0],p].every(b=>b==="force_n"||b==="bearing_n");this.put(_.slice(0,g)+_.slice(g,m.from).replace(a[0],p)+(y?_.slice(m.from,m.to):this.proposed(p,t))+_.slice(m.to))}},...fh.filter(([p])=>p==="acceleration_mm_s2"!==l).map(([p,_])=>S("option",{value:p,selected:p===a[0]},_)));o.append(S("div",{class:"row"},S("label",{},"kind",c),r));let h=t.keys[a[0]];if(a[2])o.append(this.vector(`value-${e}`,"",()=>Sn(this.items[e]?.keys[a[0]])??[0,0,0],p=>s(a[0],`[${p.join(", ")}]`)));else{let p=An({id:`value-${e}`,value:typeof h=="number"?h:0,"aria-label":a[1]},{},_=>s(a[0],String(_)));o.append(S("div",{class:"row"},S("label",{},a[1],p)))}let[u,d]=["",`
`],f=S("select",{id:`case-${e}`,onchange:()=>this.moveTo(this.items[e],f.value===u?null:f.value===d?this.newCase():f.value)},S("option",{value:u,selected:t.case===null},"none"),...this.cases.map(({name:p})=>S("option",{value:p,selected:t.case===p},p)),S("option",{value:d},"a new case"));return o.append(S("div",{class:"row"},S("label",{},"load case",f))),o}vector(t,e,n,s){let r=["x","y","z"].map((o,a)=>An({id:`${t}-${o}`,value:n()[a]},{},l=>{let c=[...n()];c[a]=l,s(c)}));return S("div",{class:"row three"},...r.map((o,a)=>S("label",{},`${"xyz"[a]}${e?`, ${e}`:""}`,o)))}proposed(t,e){let n=e.face>=0?this.parts.shape.view?.patch(e.face):void 0,s=n&&n.normal.length()>.5?n.normal:new C(0,0,1),r=this.toJob(s.clone().multiplyScalar(-100)).toArray();switch(t){case"force_n":case"bearing_n":return Hr(r);case"pressure_mpa":return"1";case"moment_nmm":return"[0, 0, 1000]";case"torque_nmm":return"1000";case"acceleration_mm_s2":return Hr(this.toJob(new C(0,0,MM)).toArray())}}get rotation(){let[t,e,n]=this.parts.shape.report.rotation;return new Pt().set(t[0],t[1],t[2],0,e[0],e[1],e[2],0,n[0],n[1],n[2],0,0,0,0,1)}toJob(t){return this.parts.shape.report.frame_is_part?t.applyMatrix4(this.rotation.transpose()):t}toPart(t){return this.parts.shape.report.frame_is_part?t.applyMatrix4(this.rotation):t}inFile(){if(!this.parts.shape.report)return"";let t=re(this.text,"guide","frame")==='"part"'?new Pt:this.rotation.transpose(),e=n=>{let s=Sn(n);return s?new C().fromArray(s).applyMatrix4(t).toArray().map(Vs):n};return JSON.stringify([this.items.map(n=>[n.name,n.place,Object.entries(n.keys).map(([s,r])=>[s,e(r)])]),this.cases.map((n,s)=>this.weight(s))])}turning(){if(this.items.length===0||this.parts.shape.report.frame_is_part)return{text:this.text};let t=this.rotation.transpose(),e=[...fh.filter(([,,s])=>s).map(([s])=>s),"displacement_mm"],n=this.text;for(let[s,r]of this.items.entries()){let o=!("on"in r.keys)||r.face>=0,a=!r.isFixture||["xyz","normal"].includes(String(r.keys.fix));if(!r.block||!o||!a)return{refused:`${r.name} is told in the frame of the plate (${r.place}) and does not turn with the part: choose its place as a face, or set guide.frame = "part" and give its numbers in the coordinates of the file.`};for(let c of e){let h=Sn(r.keys[c]),u=h&&this.blockAt(n,s);u&&(n=eo(n,u,c,Hr(new C().fromArray(h).applyMatrix4(t).toArray())))}let l=r.side&&this.blockAt(n,s);l&&(n=eo(n,l,"on",this.onFace(this.parts.shape.report.faces[r.face].name,r.side,!0)))}return{text:ge(n,"guide","frame",Fe("part"))}}blockAt(t,e){return Qi(t,"guide.fixture","guide.load","guide.case","guide.case.load").filter(n=>n.table!=="guide.case")[e]}chosenChanged(){let{chosen:t,report:e}=this.parts.shape;for(let m of this.panel.querySelectorAll("button.face"))m.setAttribute("aria-pressed",String(t.includes(Number(m.dataset.face))));let n=t.filter(m=>e?.faces[m]),s=n.length===0,r=document.getElementById("split");r&&(r.disabled=!(t.length===1&&n.length===1)),r?.disabled&&this.parts.viewer()?.dragging==="split"&&this.setGesture("turn");for(let m of["grow","grow-all"]){let g=document.getElementById(m);g&&(g.disabled=t.length===0)}let[o,a]=[S("button",{type:"button",id:"hold-here",disabled:s,onclick:()=>this.add("fixture")},"Hold here"),S("button",{type:"button",id:"load-here",disabled:s,onclick:()=>this.add("load")},"Load here")],l=S("button",{type:"button",id:"undo",disabled:!this.parts.job.canUndo,"aria-label":"Undo",title:"Undo (Ctrl+Z)",onclick:()=>this.parts.job.undo()},"↶"),c=S("button",{type:"button",id:"redo",disabled:!this.parts.job.canRedo,"aria-label":"Redo",title:"Redo (Ctrl+Shift+Z)",onclick:()=>this.parts.job.redo()},"↷"),h=S("button",{type:"button",id:"gravity",onclick:()=>this.add("gravity")},"Gravity"),{side:u,view:d}=this.parts.shape,f=u&&d&&t.length===1?d.patch(t[0],u).area:null,p=S("button",{type:"button",id:"other-side",onclick:()=>{u?.normal.negate(),this.chosenChanged()}},"The other part"),_=S("button",{type:"button",id:"whole-face",onclick:()=>{this.parts.shape.side=null,this.chosenChanged()}},"The whole face");this.picked.replaceChildren(t.length===0?S("p",{class:"note"},"Click a face on the part; with shift further ones. Or take them from the list."):S("ul",{class:"plain"},...t.map(m=>S("li",{},this.parts.shape.words(m)))),...f===null?[]:[S("div",{class:"row",id:"part-of-face"},S("span",{},`A part of it: ${nt(f,1)} mm²`),p,_)],S("div",{class:"row"},o,a,h,l,c)),this.draw()}add(t){let{chosen:e,report:n,view:s,side:r}=this.parts.shape,o=this.text,a=()=>{let h=Qi(o,"guide.fixture","guide.load");return h.length>0?h[h.length-1].to:o.length};t==="gravity"&&(o=Ys(o,a(),`[[guide.load]]
acceleration_mm_s2 = ${this.proposed("acceleration_mm_s2",{face:-1})}
`));let l=e.filter(h=>n?.faces[h]);if(t!=="gravity"&&l.some(h=>n.faces[h].doubtful)){this.parts.say("Another face is so alike that the name would not tell them apart. Select it by its place: on = { box_mm = [[x, y, z], [x, y, z]] } in the text of the job.",!0);return}let c=l.reduce((h,u)=>h+(s?.patch(u,r).area??0),0);for(let h of t==="gravity"?[]:l){let u=`on = ${this.onFace(n.faces[h].name,r)}`;if(t==="fixture"){o=Ys(o,a(),`[[guide.fixture]]
${u}
fix = "xyz"
`);continue}let d=s.patch(h,r),f=s.patch(l[0]).normal,p=f.length()>.5?f:new C(0,0,1),_=this.toJob(p.clone().multiplyScalar(-100*d.area/Math.max(c,1e-12)));o=Ys(o,a(),`[[guide.load]]
${u}
force_n = ${Hr(_.toArray())}
`)}this.parts.shape.chosen=[],this.parts.shape.side=null,this.put(o),this.parts.shape.onChosen()}pointOf(t){if(!t||typeof t!="object"||Array.isArray(t))return null;let e=r=>{let o=t[r];return o&&typeof o=="object"&&!Array.isArray(o)?o:null},n=Array.isArray(t.box_mm)?t.box_mm.map(r=>Sn(r)):null,s=n?.[0]&&n[1]?n[0].map((r,o)=>.5*(r+n[1][o])):null;return s??=Sn(e("plane")?.point_mm)??Sn(e("cylinder")?.point_mm)??Sn(e("sphere")?.centre_mm)??Sn(e("turned_box")?.centre_mm),s?this.pointToPart(new C().fromArray(s)):null}pointToPart(t){let{report:e}=this.parts.shape;return e.frame_is_part?t.multiplyScalar(e.scale).applyMatrix4(this.rotation).add(new C().fromArray(e.shift_mm)):t}draw(){let{view:t,chosen:e,side:n}=this.parts.shape,s=this.parts.viewer();if(!t)return;let r=new Map,o=[];for(let{face:c,side:h,isFixture:u}of this.items){let d=u?Ld:na;c>=0&&h?o.push({face:c,side:h,colour:d}):c>=0&&r.set(c,d)}if(n&&e.length===1)o.push({face:e[0],side:n,colour:Id});else for(let c of e)r.set(c,Id);t.paint(r),t.paintParts(o.filter(c=>n!==null||!e.includes(c.face)));let a=.2*t.high.distanceTo(t.low),l=[];for(let c of this.items)l.push(...this.arrows(c,a));t.setArrows(l),s?.draw()}arrows(t,e){let{view:n}=this.parts.shape,s=t.face>=0?n.patch(t.face,t.side):null,r=s?s.middle.clone():this.pointOf(t.keys.on)??n.low.clone().add(n.high).multiplyScalar(.5);if(t.isFixture){let p=(_,m)=>({at:_,along:m,length:.16*e,colour:Ld,heads:1,isCone:!0});return s?s.spread.map((_,m)=>p(_.clone(),s.normals[m].clone().negate())):[p(r,new C(0,0,1))]}let o=[],a=p=>{let _=Sn(t.keys[p]);return _&&_.some(m=>m!==0)?this.toPart(new C().fromArray(_)).normalize():null},l=(p,_,m,g)=>{let y=_.dot(g)<-1e-6;o.push({at:y?p.clone().addScaledVector(_,-m):p.clone(),along:_,length:m,colour:na,heads:1})},c=a("force_n")??a("bearing_n");c&&l(r,c,e,s?.normal??new C);let h=a("acceleration_mm_s2");h&&l(n.low.clone().add(n.high).multiplyScalar(.5).setZ(n.high.z),h,e,h.clone().negate());let u=t.keys.pressure_mpa;typeof u=="number"&&u!==0&&s&&s.spread.forEach((p,_)=>l(p,s.normals[_].clone().multiplyScalar(-Math.sign(u)),.45*e,s.normals[_]));let d=a("moment_nmm");d&&o.push({at:r,along:d,length:e,colour:na,heads:2});let f=t.keys.torque_nmm;if(typeof f=="number"&&f!==0&&t.face>=0){let p=this.parts.shape.report.faces[t.face],_=p.axis??p.normal;_&&o.push({at:r,along:new C().fromArray(_).multiplyScalar(Math.sign(f)),length:e,colour:na,heads:2})}return o}async solve(){let t=this.parts.job.wanted(),{view:e}=this.parts.shape;if(!t||!e)return;let n=this.loadsOf(this.text),s=await this.parts.run({kind:"stress",...t});if(s)try{let[r,o,a]=await Promise.all([In(s.id),cn(`v1/jobs/${s.id}/stress`),cn(`v1/jobs/${s.id}/stress/0`)]);if(this.parts.shape.view!==e)return;let l=new oh(o,()=>{document.documentElement.dataset.stress=String(s.id)});l.take(new Float32Array(a)),e.setStress(l),this.stress={view:l,id:s.id,cases:r.cases??[],report:r.report.stress,text:n,warnings:r.warnings,inside:new hh(l,s.id,e.low,e.high,this.parts)},this.shown={...this.shown,case:0,scale:null,magnified:0,isOn:!0},this.tell()}catch(r){this.parts.say(r.message,!0)}}async showCase(t){if(this.stress)try{this.stress.view.take(new Float32Array(await cn(`v1/jobs/${this.stress.id}/stress/${t}`))),this.shown={...this.shown,case:t,scale:null},this.stress.inside.setCase(t),this.colour()}catch(e){this.parts.say(e.message,!0)}}tell(){let{report:t,cases:e,warnings:n,view:s}=this.stress,r=(b,v,M="")=>S("tr",{},S("td",{},b),S("td",{class:"n",...M?{id:M}:{}},v)),o=S("input",{type:"checkbox",id:"stress-on",checked:!0,onchange:()=>{this.shown.isOn=o.checked,this.parts.shape.view?.showStress(o.checked),this.legend(),this.parts.viewer()?.draw()}}),a=S("select",{id:"quantity",onchange:()=>{this.shown={...this.shown,what:a.value,scale:null},this.colour()}},...Vd.map(([b,v,M])=>S("option",{value:b,selected:b===this.shown.what},`${v}, ${M}`))),l=S("select",{id:"case",onchange:()=>{this.showCase(Number(l.value))}},...e.map((b,v)=>S("option",{value:v},b))),c=(b,v,M)=>{let A=An({id:b},{isView:!0},x=>{let w=[...this.shown.scale??[0,1]];w[v]=x,this.shown.scale=w,this.colour()});return S("label",{},M,A)},h=s.largestMove,{low:u,high:d}=this.parts.shape.view,f=h>0?.1*d.distanceTo(u)/h:0,p=S("input",{type:"range",id:"magnify",min:0,max:1,step:.01,value:0,"aria-label":"Displacement drawn",oninput:()=>{s.setMagnified(p.valueAsNumber*f),_.textContent=`${Vs(Math.round(p.valueAsNumber*f))} times`,this.parts.viewer()?.draw()}}),_=S("output",{},"0 times"),m=S("button",{type:"button",id:"swing","aria-pressed":"false","aria-label":"Let the displacement swing",onclick:()=>{let b=m.getAttribute("aria-pressed")!=="true";m.setAttribute("aria-pressed",String(b)),m.textContent=b?"⏸":"▶";let v=performance.now(),M=A=>{m.getAttribute("aria-pressed")!=="true"||!m.isConnected||(p.value=String(.5-.5*Math.cos((A-v)/1e3*Math.PI)),p.dispatchEvent(new Event("input")),requestAnimationFrame(M))};b&&requestAnimationFrame(M)}},"▶"),g=t.peak_at_mm?.map(b=>nt(b,1)).join(", "),y=b=>(b??[]).map(v=>r(`${v.name}${e.length>1?` (${v.case})`:""}`,`${v.force_n.map(M=>nt(M,2)).join(", ")} N`));this.answer.replaceChildren(S("p",{class:"warning",id:"stale",hidden:!0},"Fixtures or loads have changed since; solve again."),S("table",{},r("Peak, von Mises",`${nt(t.max_von_mises_mpa,2)} MPa${g?` at ${g}`:""}`,"peak-stress"),...t.max_displacement_mm===void 0?[]:[r("Largest displacement",`${nt(t.max_displacement_mm,4)} mm`,"peak-moved")],...t.reserve===void 0?[]:[r("Strength along the beads over the peak",`${nt(t.reserve,2)} ×`)],...t.error_estimate===void 0?[]:[r("The mesh misses about",`${nt(100*t.error_estimate,1)} %`)],...y(t.loads),...y(t.reactions)),S("div",{class:"row"},S("label",{},"Colour by",a),...e.length>1?[S("label",{},"Case",l)]:[]),S("div",{class:"row"},c("scale-low",0,"Scale from"),c("scale-high",1,"to")),S("div",{class:"row"},m,S("label",{},"Displacement drawn",p),_),S("label",{for:"stress-on",class:"check"},o," show the stress on the part"),...this.stress.inside.fields(),...n.map(Yn)),this.colour()}colour(){if(!this.stress)return;let{proposed:t}=this.stress.view.colour(this.shown.what),e=this.shown.scale??=t;this.stress.view.setScale(...e);for(let[n,s]of[["scale-low",0],["scale-high",1]]){let r=document.getElementById(n);r&&ti(r,Number(e[s].toPrecision(4)))}this.legend(),this.parts.viewer()?.draw()}legend(){if(!this.isActive)return;let t=document.getElementById("legend"),e=this.stress!==null&&this.shown.isOn&&this.shown.scale!==null;if(t.hidden=!e,!e)return;let[,n,s]=Vd.find(([a])=>a===this.shown.what),r=S("div",{class:"ramp"});r.style.background=Ki(Ln);let o=a=>`${Number(a.toPrecision(3))} ${s}`;t.replaceChildren(S("div",{},n),r,S("div",{class:"ends"},...this.shown.scale.map(a=>S("span",{},o(a)))))}wordsAt(t,e){let{view:n}=this.parts.shape,s=this.parts.viewer();if(n?.isStressShown&&s&&this.stress){let r=e.clientX<0?null:this.stress.view.probe(s.rayAt(e.clientX,e.clientY));if(!r)return null;let[o,a]=[r.nine,rh(r.nine)];return`von Mises ${nt(lh(o),2)} MPa · principal ${a.map(l=>nt(l,2)).join(", ")} MPa · xx yy zz xy yz zx ${o.slice(0,6).map(l=>nt(l,2)).join(", ")} · moved ${nt(Math.hypot(o[6],o[7],o[8]),4)} mm · at (${r.at.toArray().map(l=>nt(l,1)).join(", ")})`}return t>=0?this.parts.shape.words(t):null}},wM=i=>JSON.stringify(i).replaceAll('"',"").replace("point_mm","point").replaceAll(",",", "),Hr=i=>`[${i.map(Vs).join(", ")}]`;function AM(i){let t=10**Math.floor(Math.log10(i/4));return[1,2,5,10].map(e=>e*t).find(e=>i/e<=5)??10*t}function Jg(i,t){let[e,n,s,r,o,a]=[360,230,52,34,12,12],l=Math.max(...i.curve.map(b=>b[0]),1e-9)*1.05,c=Math.max(i.high_n,...i.curve.map(b=>b[1]),1e-9)*1.08,h=b=>s+(e-s-o)*b/l,u=b=>n-r-(n-r-a)*b/c,d=je("svg",{class:"chart",viewBox:`0 0 ${e} ${n}`,role:"img","aria-label":`Load over displacement: the peak is ${nt(i.peak_load_n,0)} N at ${nt(i.peak_displacement_mm,3)} mm`});d.append(je("rect",{x:s,y:u(i.high_n),width:e-s-o,height:Math.max(u(i.low_n)-u(i.high_n),0),fill:"#e0a860",opacity:.3}));let f=(b,v,M)=>{d.append(v?je("path",{d:`M${s} ${u(b)}H${e-o}`,stroke:"#8884"}):je("path",{d:`M${h(b)} ${n-r}V${a}`,stroke:"#8884"}));let A=v?je("text",{x:s-6,y:u(b)+4,"text-anchor":"end"}):je("text",{x:h(b),y:n-r+15,"text-anchor":"middle"});A.textContent=nt(b,M),d.append(A)};for(let[b,v]of[[c,!0],[l,!1]]){let M=AM(b),A=Math.max(0,-Math.floor(Math.log10(M)+1e-9));for(let x=0;x*M<=b;x++)f(x*M,v,A)}let p=b=>b.map(v=>`${nt(h(Math.min(v[0],l)),1)},${nt(u(v[1]),1)}`).join(" ");d.append(je("polyline",{points:p(t),fill:"none",stroke:"#8889","stroke-width":1})),d.append(je("polyline",{points:p(i.curve),fill:"none",stroke:"#2a74b2","stroke-width":2.2,"stroke-linejoin":"round"})),d.append(je("path",{d:`M${s} ${u(i.peak_load_n)}H${e-o}`,stroke:"#c0392b","stroke-dasharray":"5 4"}));let _=je("text",{x:.5*(s+e-o),y:n-5,"text-anchor":"middle"});_.textContent="displacement, mm";let m=je("text",{x:13,y:.5*(n-r),transform:`rotate(-90 13 ${.5*(n-r)})`,"text-anchor":"middle"});m.textContent="load, N";let g=je("circle",{r:5,fill:"#c0392b",stroke:"#fff","stroke-width":1.5,id:"mark"});return d.append(_,m,g),{made:d,mark:(b,v)=>{g.setAttribute("cx",nt(h(Math.min(b,l)),1)),g.setAttribute("cy",nt(u(v),1))}}}var Kg={type:"change"},$d={type:"start"},Qg={type:"end"},mh=new ri,jg=new tn,EM=Math.cos(70*Xu.DEG2RAD),He=new C,Pn=2*Math.PI,se={NONE:-1,ROTATE:0,DOLLY:1,PAN:2,TOUCH_ROTATE:3,TOUCH_PAN:4,TOUCH_DOLLY_PAN:5,TOUCH_DOLLY_ROTATE:6},Wd=1e-6,gh=class extends Po{constructor(t,e=null){super(t,e),this.state=se.NONE,this.target=new C,this.cursor=new C,this.minDistance=0,this.maxDistance=1/0,this.minZoom=0,this.maxZoom=1/0,this.minTargetRadius=0,this.maxTargetRadius=1/0,this.minPolarAngle=0,this.maxPolarAngle=Math.PI,this.minAzimuthAngle=-1/0,this.maxAzimuthAngle=1/0,this.enableDamping=!1,this.dampingFactor=.05,this.enableZoom=!0,this.zoomSpeed=1,this.enableRotate=!0,this.rotateSpeed=1,this.keyRotateSpeed=1,this.enablePan=!0,this.panSpeed=1,this.screenSpacePanning=!0,this.keyPanSpeed=7,this.zoomToCursor=!1,this.autoRotate=!1,this.autoRotateSpeed=2,this.keys={LEFT:"ArrowLeft",UP:"ArrowUp",RIGHT:"ArrowRight",BOTTOM:"ArrowDown"},this.mouseButtons={LEFT:us.ROTATE,MIDDLE:us.DOLLY,RIGHT:us.PAN},this.touches={ONE:ds.ROTATE,TWO:ds.DOLLY_PAN},this.target0=this.target.clone(),this.position0=this.object.position.clone(),this.zoom0=this.object.zoom,this._cursorStyle="auto",this._domElementKeyEvents=null,this._lastPosition=new C,this._lastQuaternion=new Oe,this._lastTargetPosition=new C,this._quat=new Oe().setFromUnitVectors(t.up,new C(0,1,0)),this._quatInverse=this._quat.clone().invert(),this._spherical=new br,this._sphericalDelta=new br,this._scale=1,this._panOffset=new C,this._rotateStart=new St,this._rotateEnd=new St,this._rotateDelta=new St,this._panStart=new St,this._panEnd=new St,this._panDelta=new St,this._dollyStart=new St,this._dollyEnd=new St,this._dollyDelta=new St,this._dollyDirection=new C,this._mouse=new St,this._performCursorZoom=!1,this._pointers=[],this._pointerPositions={},this._controlActive=!1,this._onPointerMove=RM.bind(this),this._onPointerDown=TM.bind(this),this._onPointerUp=CM.bind(this),this._onContextMenu=UM.bind(this),this._onMouseWheel=LM.bind(this),this._onKeyDown=DM.bind(this),this._onTouchStart=NM.bind(this),this._onTouchMove=FM.bind(this),this._onMouseDown=PM.bind(this),this._onMouseMove=IM.bind(this),this._interceptControlDown=OM.bind(this),this._interceptControlUp=BM.bind(this),this.domElement!==null&&this.connect(this.domElement),this.update()}set cursorStyle(t){this._cursorStyle=t,t==="grab"?this.domElement.style.cursor="grab":this.domElement.style.cursor="auto"}get cursorStyle(){return this._cursorStyle}connect(t){super.connect(t),this.domElement.addEventListener("pointerdown",this._onPointerDown),this.domElement.addEventListener("pointercancel",this._onPointerUp),this.domElement.addEventListener("contextmenu",this._onContextMenu),this.domElement.addEventListener("wheel",this._onMouseWheel,{passive:!1}),this.domElement.ownerDocument.addEventListener("keydown",this._interceptControlDown,{passive:!0,capture:!0}),this.domElement.style.touchAction="none"}disconnect(){this.state=se.NONE,this.domElement.removeEventListener("pointerdown",this._onPointerDown),this.domElement.ownerDocument.removeEventListener("pointermove",this._onPointerMove),this.domElement.ownerDocument.removeEventListener("pointerup",this._onPointerUp),this.domElement.removeEventListener("pointercancel",this._onPointerUp),this.domElement.removeEventListener("wheel",this._onMouseWheel),this.domElement.removeEventListener("contextmenu",this._onContextMenu),this.stopListenToKeyEvents(),this.domElement.ownerDocument.removeEventListener("keydown",this._interceptControlDown,{capture:!0}),this.domElement.ownerDocument.removeEventListener("keyup",this._interceptControlUp,{capture:!0}),this._controlActive=!1,this._pointers.length=0,this._pointerPositions={},this.domElement.style.touchAction="",this.domElement.style.cursor="auto"}dispose(){this.disconnect()}getPolarAngle(){return this._spherical.phi}getAzimuthalAngle(){return this._spherical.theta}getDistance(){return this.object.position.distanceTo(this.target)}listenToKeyEvents(t){t.addEventListener("keydown",this._onKeyDown),this._domElementKeyEvents=t}stopListenToKeyEvents(){this._domElementKeyEvents!==null&&(this._domElementKeyEvents.removeEventListener("keydown",this._onKeyDown),this._domElementKeyEvents=null)}saveState(){this.target0.copy(this.target),this.position0.copy(this.object.position),this.zoom0=this.object.zoom}reset(){this.target.copy(this.target0),this.object.position.copy(this.position0),this.object.zoom=this.zoom0,this.object.updateProjectionMatrix(),this.dispatchEvent(Kg),this.update(),this.state=se.NONE}pan(t,e){this._pan(t,e),this.update()}dollyIn(t){this._dollyIn(t),this.update()}dollyOut(t){this._dollyOut(t),this.update()}rotateLeft(t){this._rotateLeft(t),this.update()}rotateUp(t){this._rotateUp(t),this.update()}update(t=null){let e=this.object.position;He.copy(e).sub(this.target),He.applyQuaternion(this._quat),this._spherical.setFromVector3(He),this.autoRotate&&this.state===se.NONE&&this._rotateLeft(this._getAutoRotationAngle(t)),this.enableDamping?(this._spherical.theta+=this._sphericalDelta.theta*this.dampingFactor,this._spherical.phi+=this._sphericalDelta.phi*this.dampingFactor):(this._spherical.theta+=this._sphericalDelta.theta,this._spherical.phi+=this._sphericalDelta.phi);let n=this.minAzimuthAngle,s=this.maxAzimuthAngle;isFinite(n)&&isFinite(s)&&(n<-Math.PI?n+=Pn:n>Math.PI&&(n-=Pn),s<-Math.PI?s+=Pn:s>Math.PI&&(s-=Pn),n<=s?this._spherical.theta=Math.max(n,Math.min(s,this._spherical.theta)):this._spherical.theta=this._spherical.theta>(n+s)/2?Math.max(n,this._spherical.theta):Math.min(s,this._spherical.theta)),this._spherical.phi=Math.max(this.minPolarAngle,Math.min(this.maxPolarAngle,this._spherical.phi)),this._spherical.makeSafe(),this.enableDamping===!0?this.target.addScaledVector(this._panOffset,this.dampingFactor):this.target.add(this._panOffset),this.target.sub(this.cursor),this.target.clampLength(this.minTargetRadius,this.maxTargetRadius),this.target.add(this.cursor);let r=!1;if(this.zoomToCursor&&this._performCursorZoom||this.object.isOrthographicCamera)this._spherical.radius=this._clampDistance(this._spherical.radius);else{let o=this._spherical.radius;this._spherical.radius=this._clampDistance(this._spherical.radius*this._scale),r=o!=this._spherical.radius}if(He.setFromSpherical(this._spherical),He.applyQuaternion(this._quatInverse),e.copy(this.target).add(He),this.object.lookAt(this.target),this.enableDamping===!0?(this._sphericalDelta.theta*=1-this.dampingFactor,this._sphericalDelta.phi*=1-this.dampingFactor,this._panOffset.multiplyScalar(1-this.dampingFactor)):(this._sphericalDelta.set(0,0,0),this._panOffset.set(0,0,0)),this.zoomToCursor&&this._performCursorZoom){let o=null;if(this.object.isPerspectiveCamera){let a=He.length();o=this._clampDistance(a*this._scale);let l=a-o;this.object.position.addScaledVector(this._dollyDirection,l),this.object.updateMatrixWorld(),r=!!l}else if(this.object.isOrthographicCamera){let a=new C(this._mouse.x,this._mouse.y,0);a.unproject(this.object);let l=this.object.zoom;this.object.zoom=Math.max(this.minZoom,Math.min(this.maxZoom,this.object.zoom/this._scale)),this.object.updateProjectionMatrix(),r=l!==this.object.zoom;let c=new C(this._mouse.x,this._mouse.y,0);c.unproject(this.object),this.object.position.sub(c).add(a),this.object.updateMatrixWorld(),o=He.length()}else console.warn("WARNING: OrbitControls.js encountered an unknown camera type - zoom to cursor disabled."),this.zoomToCursor=!1;o!==null&&(this.screenSpacePanning?this.target.set(0,0,-1).transformDirection(this.object.matrix).multiplyScalar(o).add(this.object.position):(mh.origin.copy(this.object.position),mh.direction.set(0,0,-1).transformDirection(this.object.matrix),Math.abs(this.object.up.dot(mh.direction))<EM?this.object.lookAt(this.target):(jg.setFromNormalAndCoplanarPoint(this.object.up,this.target),mh.intersectPlane(jg,this.target))))}else if(this.object.isOrthographicCamera){let o=this.object.zoom;this.object.zoom=Math.max(this.minZoom,Math.min(this.maxZoom,this.object.zoom/this._scale)),o!==this.object.zoom&&(this.object.updateProjectionMatrix(),r=!0)}return this._scale=1,this._performCursorZoom=!1,r||this._lastPosition.distanceToSquared(this.object.position)>Wd||8*(1-this._lastQuaternion.dot(this.object.quaternion))>Wd||this._lastTargetPosition.distanceToSquared(this.target)>Wd?(this.dispatchEvent(Kg),this._lastPosition.copy(this.object.position),this._lastQuaternion.copy(this.object.quaternion),this._lastTargetPosition.copy(this.target),!0):!1}_getAutoRotationAngle(t){return t!==null?Pn/60*this.autoRotateSpeed*t:Pn/60/60*this.autoRotateSpeed}_getZoomScale(t){let e=Math.abs(t*.01);return Math.pow(.95,this.zoomSpeed*e)}_rotateLeft(t){this._sphericalDelta.theta-=t}_rotateUp(t){this._sphericalDelta.phi-=t}_panLeft(t,e){He.setFromMatrixColumn(e,0),He.multiplyScalar(-t),this._panOffset.add(He)}_panUp(t,e){this.screenSpacePanning===!0?He.setFromMatrixColumn(e,1):(He.setFromMatrixColumn(e,0),He.crossVectors(this.object.up,He)),He.multiplyScalar(t),this._panOffset.add(He)}_pan(t,e){let n=this.domElement;if(this.object.isPerspectiveCamera){let s=this.object.position;He.copy(s).sub(this.target);let r=He.length();r*=Math.tan(this.object.fov/2*Math.PI/180),this._panLeft(2*t*r/n.clientHeight,this.object.matrix),this._panUp(2*e*r/n.clientHeight,this.object.matrix)}else this.object.isOrthographicCamera?(this._panLeft(t*(this.object.right-this.object.left)/this.object.zoom/n.clientWidth,this.object.matrix),this._panUp(e*(this.object.top-this.object.bottom)/this.object.zoom/n.clientHeight,this.object.matrix)):(console.warn("WARNING: OrbitControls.js encountered an unknown camera type - pan disabled."),this.enablePan=!1)}_dollyOut(t){this.object.isPerspectiveCamera||this.object.isOrthographicCamera?this._scale/=t:(console.warn("WARNING: OrbitControls.js encountered an unknown camera type - dolly/zoom disabled."),this.enableZoom=!1)}_dollyIn(t){this.object.isPerspectiveCamera||this.object.isOrthographicCamera?this._scale*=t:(console.warn("WARNING: OrbitControls.js encountered an unknown camera type - dolly/zoom disabled."),this.enableZoom=!1)}_updateZoomParameters(t,e){if(!this.zoomToCursor)return;this._performCursorZoom=!0;let n=this.domElement.getBoundingClientRect(),s=t-n.left,r=e-n.top,o=n.width,a=n.height;this._mouse.x=s/o*2-1,this._mouse.y=-(r/a)*2+1,this._dollyDirection.set(this._mouse.x,this._mouse.y,1).unproject(this.object).sub(this.object.position).normalize()}_clampDistance(t){return Math.max(this.minDistance,Math.min(this.maxDistance,t))}_handleMouseDownRotate(t){this._rotateStart.set(t.clientX,t.clientY)}_handleMouseDownDolly(t){this._updateZoomParameters(t.clientX,t.clientY),this._dollyStart.set(t.clientX,t.clientY)}_handleMouseDownPan(t){this._panStart.set(t.clientX,t.clientY)}_handleMouseMoveRotate(t){this._rotateEnd.set(t.clientX,t.clientY),this._rotateDelta.subVectors(this._rotateEnd,this._rotateStart).multiplyScalar(this.rotateSpeed);let e=this.domElement;this._rotateLeft(Pn*this._rotateDelta.x/e.clientHeight),this._rotateUp(Pn*this._rotateDelta.y/e.clientHeight),this._rotateStart.copy(this._rotateEnd),this.update()}_handleMouseMoveDolly(t){this._dollyEnd.set(t.clientX,t.clientY),this._dollyDelta.subVectors(this._dollyEnd,this._dollyStart),this._dollyDelta.y>0?this._dollyOut(this._getZoomScale(this._dollyDelta.y)):this._dollyDelta.y<0&&this._dollyIn(this._getZoomScale(this._dollyDelta.y)),this._dollyStart.copy(this._dollyEnd),this.zoomToCursor&&(this._performCursorZoom=!0,this._dollyDirection.set(this._mouse.x,this._mouse.y,1).unproject(this.object).sub(this.object.position).normalize()),this.update()}_handleMouseMovePan(t){this._panEnd.set(t.clientX,t.clientY),this._panDelta.subVectors(this._panEnd,this._panStart).multiplyScalar(this.panSpeed),this._pan(this._panDelta.x,this._panDelta.y),this._panStart.copy(this._panEnd),this.update()}_handleMouseWheel(t){this._updateZoomParameters(t.clientX,t.clientY),t.deltaY<0?this._dollyIn(this._getZoomScale(t.deltaY)):t.deltaY>0&&this._dollyOut(this._getZoomScale(t.deltaY)),this.update()}_handleKeyDown(t){let e=!1;switch(t.code){case this.keys.UP:t.ctrlKey||t.metaKey||t.shiftKey?this.enableRotate&&this._rotateUp(Pn*this.keyRotateSpeed/this.domElement.clientHeight):this.enablePan&&this._pan(0,this.keyPanSpeed),e=!0;break;case this.keys.BOTTOM:t.ctrlKey||t.metaKey||t.shiftKey?this.enableRotate&&this._rotateUp(-Pn*this.keyRotateSpeed/this.domElement.clientHeight):this.enablePan&&this._pan(0,-this.keyPanSpeed),e=!0;break;case this.keys.LEFT:t.ctrlKey||t.metaKey||t.shiftKey?this.enableRotate&&this._rotateLeft(Pn*this.keyRotateSpeed/this.domElement.clientHeight):this.enablePan&&this._pan(this.keyPanSpeed,0),e=!0;break;case this.keys.RIGHT:t.ctrlKey||t.metaKey||t.shiftKey?this.enableRotate&&this._rotateLeft(-Pn*this.keyRotateSpeed/this.domElement.clientHeight):this.enablePan&&this._pan(-this.keyPanSpeed,0),e=!0;break}e&&(t.preventDefault(),this.update())}_handleTouchStartRotate(t){if(this._pointers.length===1)this._rotateStart.set(t.pageX,t.pageY);else{let e=this._getSecondPointerPosition(t),n=.5*(t.pageX+e.x),s=.5*(t.pageY+e.y);this._rotateStart.set(n,s)}}_handleTouchStartPan(t){if(this._pointers.length===1)this._panStart.set(t.pageX,t.pageY);else{let e=this._getSecondPointerPosition(t),n=.5*(t.pageX+e.x),s=.5*(t.pageY+e.y);this._panStart.set(n,s)}}_handleTouchStartDolly(t){let e=this._getSecondPointerPosition(t),n=t.pageX-e.x,s=t.pageY-e.y,r=Math.sqrt(n*n+s*s);this._dollyStart.set(0,r)}_handleTouchStartDollyPan(t){this.enableZoom&&this._handleTouchStartDolly(t),this.enablePan&&this._handleTouchStartPan(t)}_handleTouchStartDollyRotate(t){this.enableZoom&&this._handleTouchStartDolly(t),this.enableRotate&&this._handleTouchStartRotate(t)}_handleTouchMoveRotate(t){if(this._pointers.length==1)this._rotateEnd.set(t.pageX,t.pageY);else{let n=this._getSecondPointerPosition(t),s=.5*(t.pageX+n.x),r=.5*(t.pageY+n.y);this._rotateEnd.set(s,r)}this._rotateDelta.subVectors(this._rotateEnd,this._rotateStart).multiplyScalar(this.rotateSpeed);let e=this.domElement;this._rotateLeft(Pn*this._rotateDelta.x/e.clientHeight),this._rotateUp(Pn*this._rotateDelta.y/e.clientHeight),this._rotateStart.copy(this._rotateEnd)}_handleTouchMovePan(t){if(this._pointers.length===1)this._panEnd.set(t.pageX,t.pageY);else{let e=this._getSecondPointerPosition(t),n=.5*(t.pageX+e.x),s=.5*(t.pageY+e.y);this._panEnd.set(n,s)}this._panDelta.subVectors(this._panEnd,this._panStart).multiplyScalar(this.panSpeed),this._pan(this._panDelta.x,this._panDelta.y),this._panStart.copy(this._panEnd)}_handleTouchMoveDolly(t){let e=this._getSecondPointerPosition(t),n=t.pageX-e.x,s=t.pageY-e.y,r=Math.sqrt(n*n+s*s);this._dollyEnd.set(0,r),this._dollyDelta.set(0,Math.pow(this._dollyEnd.y/this._dollyStart.y,this.zoomSpeed)),this._dollyOut(this._dollyDelta.y),this._dollyStart.copy(this._dollyEnd);let o=(t.pageX+e.x)*.5,a=(t.pageY+e.y)*.5;this._updateZoomParameters(o,a)}_handleTouchMoveDollyPan(t){this.enableZoom&&this._handleTouchMoveDolly(t),this.enablePan&&this._handleTouchMovePan(t)}_handleTouchMoveDollyRotate(t){this.enableZoom&&this._handleTouchMoveDolly(t),this.enableRotate&&this._handleTouchMoveRotate(t)}_addPointer(t){this._pointers.push(t.pointerId)}_removePointer(t){delete this._pointerPositions[t.pointerId];for(let e=0;e<this._pointers.length;e++)if(this._pointers[e]==t.pointerId){this._pointers.splice(e,1);return}}_isTrackingPointer(t){for(let e=0;e<this._pointers.length;e++)if(this._pointers[e]==t.pointerId)return!0;return!1}_trackPointer(t){let e=this._pointerPositions[t.pointerId];e===void 0&&(e=new St,this._pointerPositions[t.pointerId]=e),e.set(t.pageX,t.pageY)}_getSecondPointerPosition(t){let e=t.pointerId===this._pointers[0]?this._pointers[1]:this._pointers[0];return this._pointerPositions[e]}_customWheelEvent(t){let e=t.deltaMode,n={clientX:t.clientX,clientY:t.clientY,deltaY:t.deltaY};switch(e){case 1:n.deltaY*=16;break;case 2:n.deltaY*=100;break}return t.ctrlKey&&!this._controlActive&&(n.deltaY*=10),n}};function TM(i){this.enabled!==!1&&(this._pointers.length===0&&(this.domElement.setPointerCapture(i.pointerId),this.domElement.ownerDocument.addEventListener("pointermove",this._onPointerMove),this.domElement.ownerDocument.addEventListener("pointerup",this._onPointerUp)),!this._isTrackingPointer(i)&&(this._addPointer(i),i.pointerType==="touch"?this._onTouchStart(i):this._onMouseDown(i),this._cursorStyle==="grab"&&(this.domElement.style.cursor="grabbing")))}function RM(i){this.enabled!==!1&&(i.pointerType==="touch"?this._onTouchMove(i):this._onMouseMove(i))}function CM(i){switch(this._removePointer(i),this._pointers.length){case 0:this.domElement.releasePointerCapture(i.pointerId),this.domElement.ownerDocument.removeEventListener("pointermove",this._onPointerMove),this.domElement.ownerDocument.removeEventListener("pointerup",this._onPointerUp),this.dispatchEvent(Qg),this.state=se.NONE,this._cursorStyle==="grab"&&(this.domElement.style.cursor="grab");break;case 1:let t=this._pointers[0],e=this._pointerPositions[t];this._onTouchStart({pointerId:t,pageX:e.x,pageY:e.y});break}}function PM(i){let t;switch(i.button){case 0:t=this.mouseButtons.LEFT;break;case 1:t=this.mouseButtons.MIDDLE;break;case 2:t=this.mouseButtons.RIGHT;break;default:t=-1}switch(t){case us.DOLLY:if(this.enableZoom===!1)return;this._handleMouseDownDolly(i),this.state=se.DOLLY;break;case us.ROTATE:if(i.ctrlKey||i.metaKey||i.shiftKey){if(this.enablePan===!1)return;this._handleMouseDownPan(i),this.state=se.PAN}else{if(this.enableRotate===!1)return;this._handleMouseDownRotate(i),this.state=se.ROTATE}break;case us.PAN:if(i.ctrlKey||i.metaKey||i.shiftKey){if(this.enableRotate===!1)return;this._handleMouseDownRotate(i),this.state=se.ROTATE}else{if(this.enablePan===!1)return;this._handleMouseDownPan(i),this.state=se.PAN}break;default:this.state=se.NONE}this.state!==se.NONE&&this.dispatchEvent($d)}function IM(i){switch(this.state){case se.ROTATE:if(this.enableRotate===!1)return;this._handleMouseMoveRotate(i);break;case se.DOLLY:if(this.enableZoom===!1)return;this._handleMouseMoveDolly(i);break;case se.PAN:if(this.enablePan===!1)return;this._handleMouseMovePan(i);break}}function LM(i){this.enabled===!1||this.enableZoom===!1||this.state!==se.NONE||(i.preventDefault(),this.dispatchEvent($d),this._handleMouseWheel(this._customWheelEvent(i)),this.dispatchEvent(Qg))}function DM(i){this.enabled!==!1&&this._handleKeyDown(i)}function NM(i){switch(this._trackPointer(i),this._pointers.length){case 1:switch(this.touches.ONE){case ds.ROTATE:if(this.enableRotate===!1){this.state=se.NONE;break}this._handleTouchStartRotate(i),this.state=se.TOUCH_ROTATE;break;case ds.PAN:if(this.enablePan===!1){this.state=se.NONE;break}this._handleTouchStartPan(i),this.state=se.TOUCH_PAN;break;default:this.state=se.NONE}break;case 2:switch(this.touches.TWO){case ds.DOLLY_PAN:if(this.enableZoom===!1&&this.enablePan===!1)return;this._handleTouchStartDollyPan(i),this.state=se.TOUCH_DOLLY_PAN;break;case ds.DOLLY_ROTATE:if(this.enableZoom===!1&&this.enableRotate===!1)return;this._handleTouchStartDollyRotate(i),this.state=se.TOUCH_DOLLY_ROTATE;break;default:this.state=se.NONE}break;default:this.state=se.NONE}this.state!==se.NONE&&this.dispatchEvent($d)}function FM(i){switch(this._trackPointer(i),this.state){case se.TOUCH_ROTATE:if(this.enableRotate===!1)return;this._handleTouchMoveRotate(i),this.update();break;case se.TOUCH_PAN:if(this.enablePan===!1)return;this._handleTouchMovePan(i),this.update();break;case se.TOUCH_DOLLY_PAN:if(this.enableZoom===!1&&this.enablePan===!1)return;this._handleTouchMoveDollyPan(i),this.update();break;case se.TOUCH_DOLLY_ROTATE:if(this.enableZoom===!1&&this.enableRotate===!1)return;this._handleTouchMoveDollyRotate(i),this.update();break;default:this.state=se.NONE}}function UM(i){this.enabled!==!1&&i.preventDefault()}function OM(i){i.key==="Control"&&(this._controlActive=!0,this.domElement.ownerDocument.addEventListener("keyup",this._interceptControlUp,{passive:!0,capture:!0}))}function BM(i){i.key==="Control"&&(this._controlActive=!1,this.domElement.ownerDocument.removeEventListener("keyup",this._interceptControlUp,{passive:!0,capture:!0}))}var t0=6e4,e0=12,kM=3e6,Xd=i=>Zi.findIndex(([t])=>t===i),o0=Zi.length,_h=qe+4,n0=.6,zM=2,qd=i=>`vec3(${i.map(t=>(t/255).toFixed(4)).join(", ")})`,a0=`
${Zi.map(([i])=>`#define BY_${i.toUpperCase()} ${Xd(i)}`).join(`
`)}
#define BY_BREAK ${o0}
`,VM=`${a0}
in vec2 a; in vec2 b; in vec4 meta;
uniform vec2 origin; uniform float unit; uniform sampler2D heights; uniform float firstRecord; uniform vec2 range; uniform vec2 scale;
uniform vec3 classColours[${_h}]; uniform float classShown[${_h}]; uniform sampler2D speeds; uniform sampler2D colours; uniform sampler2D circleColours; uniform float hovered; uniform float ghost;
flat out vec3 colour; flat out vec4 lit; out float side;
#if BY == BY_BREAK
out vec3 at;
#elif BY == BY_SEAM
out float fromSeam;
#endif
void main() {
  colour = vec3(0.0); lit = vec4(0.0); side = position.y;
#if BY == BY_BREAK
  at = vec3(0.0);
#elif BY == BY_SEAM
  fromSeam = 1e6;
#endif
  float record = firstRecord + float(gl_InstanceID) + 1.0;
  float kind = mod(meta.y, 128.0); bool isSeam = mod(meta.y, 256.0) > 127.5; float speedAt = floor(meta.y / 256.0);
  int k = int(kind + 0.5);
  vec4 layer = texelFetch(heights, ivec2(int(meta.z) % 256, int(meta.z) / 256), 0);
  vec2 h = layer.rg;
  bool shown = record >= range.x && record <= range.y && k != ${qe+1} && classShown[k] > 0.5;
  vec2 p = origin + unit * a; vec2 q = origin + unit * b; vec2 d = q - p; float len = length(d);
  if (shown && k > ${qe}) {
    // A mark that faces the eye: on its corner where filament is pulled back, upright where it is pushed again.
    vec2 e = vec2(2.0 * position.x - 1.0, position.y) * ${n0};
    if (k == ${qe+2}) e = 0.7 * vec2(e.x - e.y, e.x + e.y);
    colour = mix(classColours[k], vec3(0.72, 0.75, 0.77), ghost);
    gl_Position = projectionMatrix * (viewMatrix * vec4(vec3(q, h.r + ${n0}), 1.0) + vec4(e, 0.0, 0.0));
    return;
  }
  if (!shown || len < 1e-6) { gl_Position = vec4(2.0, 2.0, 2.0, 0.0); return; }
  vec2 along = d / len; vec2 across = vec2(-along.y, along.x);
  bool travel = k == ${qe};
  float width = travel ? 0.12 : meta.x * 1e-3;
  float over = travel ? 0.0 : 0.3 * width;
  vec2 radii = vec2(0.5 * width, (travel ? 0.1 : 0.45) * h.g);
  // A roof: its ridge is upright, its feet are across. A ribbon turns to the eye, as wide as the bead is seen.
  vec3 middle = vec3(0.0, 0.0, 1.0); vec3 edge = vec3(across, 0.0);
  vec3 place = vec3(mix(p - over * along, q + over * along, position.x), h.r - radii.y);
  if (position.z < 0.0) {
    vec3 eye = cross(vec3(along, 0.0), cameraPosition - place);
    if (dot(eye, eye) > 1e-12) edge = normalize(eye);
    middle = cross(edge, vec3(along, 0.0));
    vec2 e = radii * vec2(dot(edge.xy, across), edge.z); vec2 m = radii * vec2(dot(middle.xy, across), middle.z);
    place += middle * length(m) + edge * length(e) * position.y;
  } else place += vec3(across * radii.x * position.y, (2.0 * position.z - 1.0) * radii.y);
  colour = classColours[k];
#if BY == BY_ANGLE
  if (!travel) { float turn = atan(along.y, along.x) / 3.14159265; colour = texture(circleColours, vec2(turn - floor(turn), 0.5)).rgb; }
#elif BY == BY_SEAM
  if (!travel) colour = ${qd(As)};
#elif BY != BY_ROLE && BY != BY_BREAK
  float speed = texelFetch(speeds, ivec2(int(speedAt), 0), 0).r;
#if BY == BY_SPEED
  float value = speed;
#elif BY == BY_WIDTH
  float value = width;
#elif BY == BY_FLOW
  float value = max(h.g * (width - h.g * 0.2146), 0.0) * speed;
#elif BY == BY_HEIGHT
  float value = h.r;
#elif BY == BY_TIME
  float value = layer.b;
#elif BY == BY_LOAD
  float own = mod(meta.w, 256.0); float value = 0.5 * own;
#elif BY == BY_RESERVE
  float own = floor(meta.w / 256.0); float value = (${Ih}.0 - own) / ${Lh}.0;
#endif
#if BY == BY_LOAD || BY == BY_RESERVE
  if (own > 254.5) colour = travel ? colour : ${qd(As)}; else
#endif
  if (!travel) colour = texture(colours, vec2(clamp((value - scale.x) / max(scale.y - scale.x, 1e-6), 0.002, 0.998), 0.5)).rgb;
#endif
  colour = mix(colour, vec3(0.72, 0.75, 0.77), ghost);
  if (abs(record - hovered) < 0.5) colour = vec3(1.0, 0.95, 0.35);
#if BY == BY_SEAM
  // Along the bead, in its widths.
  if (isSeam) fromSeam = position.x * (len + 2.0 * over) / width;
#elif BY == BY_BREAK
  at = vec3(place.xy, h.r - 0.5 * h.g);
#endif
  // Light from above and a little from the left: of the middle, and of the edge.
  vec3 left = vec3(-0.7, 0.5, 0.0);
  lit = travel ? vec4(0.0) : vec4(0.48 * middle.z + 0.10 * dot(middle, left), 0.48 * edge.z + 0.10 * dot(edge, left), 1.0, 0.0);
  gl_Position = projectionMatrix * (viewMatrix * vec4(place, 1.0));
}`,GM=`${a0}
flat in vec3 colour; flat in vec4 lit; in float side; out vec4 result;
#if BY == BY_BREAK
in vec3 at; uniform sampler3D breaks; uniform mat4 breaksFrom; uniform float state; uniform sampler2D colours;
#elif BY == BY_SEAM
in float fromSeam;
#endif
void main() {
  vec3 tone = colour;
#if BY == BY_SEAM
  if (fromSeam < ${zM.toFixed(1)}) tone = ${qd(ma)};
#elif BY == BY_BREAK
  vec3 g = (breaksFrom * vec4(at, 1.0)).xyz;
  vec2 found = texture(breaks, g).rg;
  bool isIn = all(greaterThan(g, vec3(0.0))) && all(lessThan(g, vec3(1.0)));
  tone = isIn && found.x > 0.0 && found.x <= state + 1.0 ? texture(colours, vec2(clamp(found.y, 0.002, 0.998), 0.5)).rgb : vec3(0.72, 0.75, 0.77);
#endif
  // The ridge of a bead keeps its colour, its flanks are darker: the normal turns from the middle to the edge.
  vec2 n = normalize(vec2(1.0 - abs(side), side));
  float shade = lit.z > 0.5 ? 0.52 + max(dot(n, lit.xy), -0.1) : 1.0;
  result = vec4(tone * shade, 1.0);
}`;function Yd([i,t],e,n){let[s,r]=[[...i],[...t]],o="xyz".indexOf(e[0]);return e[1]==="-"?r[o]=Math.min(r[o],s[o]+n):s[o]=Math.max(s[o],r[o]-n),[s,r]}var Gs=5,HM=4,i0=7;function l0(i){let t=i.getExtension("WEBGL_debug_renderer_info");return String(t?i.getParameter(t.UNMASKED_RENDERER_WEBGL):i.getParameter(i.RENDERER))}function WM(){let i=document.createElement("canvas").getContext("webgl2"),t=i!==null&&/llvmpipe|swiftshader|softpipe|basic render/i.test(l0(i));return i?.getExtension("WEBGL_lose_context")?.loseContext(),t}var yh=class{constructor(t){this.canvas=t;this.renderer=new Cc({canvas:t,antialias:!WM(),alpha:!0}),this.camera.up.set(0,0,1),this.controls=new gh(this.camera,t),this.controls.addEventListener("change",()=>this.draw()),this.controls.addEventListener("start",()=>this.fitted=null),this.material=new Ie({glslVersion:Cn,vertexShader:VM,fragmentShader:GM,side:Te,defines:{BY:Xd("role")},uniforms:{origin:{value:new St},unit:{value:1},heights:{value:null},firstRecord:{value:0},range:{value:new St(0,-1)},scale:{value:new St(0,1)},speeds:{value:null},hovered:{value:-1},ghost:{value:0},classColours:{value:Array.from({length:_h},(n,s)=>new C(...(Ji[s]??ga[s-qe-2]??As).map(r=>r/255)))},classShown:{value:this.classShown},breaks:{value:null},breaksFrom:{value:new Pt},state:{value:0},colours:{value:r0(Ln)},circleColours:{value:r0(_a)}}});for(let n of[qe,qe+2,qe+3])this.setShown(n,!1);this.scene.add(this.plate,this.chunks,this.window,this.places,this.broken),new ResizeObserver(()=>this.resize()).observe(t),t.addEventListener("pointermove",n=>this.move(n)),t.addEventListener("pointerleave",()=>{this.pointer=null,this.hover(-1),this.setHovered(-1),this.onFace(-1,{clientX:-1,clientY:-1})});let e=null;t.addEventListener("pointerdown",n=>e=[n.clientX,n.clientY]),t.addEventListener("pointerup",n=>{e&&Math.hypot(n.clientX-e[0],n.clientY-e[1])<4&&this.pick(n),e=null}),this.dragFaces()}canvas;renderer;camera=new _n(35,1,.1,1e4);controls;beads=null;onHover=()=>{};onPick=()=>{};picking=!1;scene=new _o;plate=new ze;chunks=new ze;places=new ze;broken=new ze;window=new ze;part=null;onFace=()=>{};onPickFace=()=>{};onPickFaces=()=>{};onPaint=()=>{};onPaintEnd=()=>{};onSplit=()=>{};gesture="turn";mode="paths";material;shown={low:0,high:0,from:0,to:0};isDirty=!1;fitted=null;classShown=new Array(_h).fill(1);pointer=null;nearestFirst(){let t=this.camera.position.z>this.controls.target.z;this.chunks.children.forEach((e,n)=>e.renderOrder=t?-n:n-e0)}get rendererName(){return l0(this.renderer.getContext())}draw(){this.isDirty||(this.isDirty=!0,requestAnimationFrame(()=>{this.isDirty=!1,this.nearestFirst(),this.renderer.render(this.scene,this.camera)}))}resize(){let{clientWidth:t,clientHeight:e}=this.canvas;t===0||e===0||(this.renderer.setPixelRatio(Math.min(devicePixelRatio,2)),this.renderer.setSize(t,e,!1),this.camera.aspect=t/e,this.camera.updateProjectionMatrix(),this.fitted&&(this.beads||this.part)&&this.view(this.fitted),this.draw())}setMode(t){this.mode!==t&&(this.mode=t,this.modeChanged())}get isPartShown(){return this.mode==="part"&&this.part!==null}modeChanged(){let t=this.isPartShown;for(let e of[this.chunks,this.window,this.places,this.broken])e.visible=!t;this.part&&(this.part.group.visible=t),this.drawPlate(),this.view(this.fitted??"oblique")}setPart(t,e=!1){this.part&&(this.scene.remove(this.part.group),this.part.dispose()),this.part=t,t&&this.scene.add(t.group),e||(this.fitted??="oblique"),this.modeChanged()}rayAt(t,e){return this.ray({clientX:t,clientY:e}).ray}clear(){for(let t of[this.chunks,this.window,this.places,this.broken])sa(t);for(let t of["heights","speeds","breaks"])this.material.uniforms[t].value?.dispose(),this.material.uniforms[t].value=null;this.beads=null,this.drawPlate(),this.draw()}show(t,e=!1){this.clear(),this.beads=t;let{index:n}=t,s=this.material.uniforms;s.origin.value.set(...n.origin_mm),s.unit.value=n.step_mm;let r=Math.max(1,Math.ceil(n.layers.length/256)),o=new Float32Array(256*r*4);n.layers.forEach((u,d)=>o.set([u.z_mm,u.height_mm,u.time_s??0,0],4*d)),s.heights.value=s0(o,256,r,sn);let a=new Float32Array(256);a.set(n.speeds_mm_s.slice(0,256)),s.speeds.value=s0(a,256,1,Do);let l=t.first[n.layers.length],c=Math.max(t0,Math.ceil(l/e0)),h=0;for(let u=0;u<n.layers.length;u++){let d=u===n.layers.length-1;(t.first[u+1]-t.first[h]>=c||d)&&(this.chunks.add(this.chunk(t.words.subarray(Ne*t.first[h],Ne*t.first[u+1]),t.first[h],!0)),h=u+1)}this.drawPlate(),e?this.fitted&&this.view(this.fitted):this.view("oblique")}chunk(t,e,n){let s=new ki;n?(s.setAttribute("position",new Ht(new Float32Array([0,1,-1,0,-1,-1,1,1,-1,1,-1,-1]),3)),s.setIndex([0,1,3,0,3,2])):(s.setAttribute("position",new Ht(new Float32Array([0,1,0,0,0,1,0,-1,0,1,1,0,1,0,1,1,-1,0]),3)),s.setIndex([0,1,4,0,4,3,1,2,5,1,5,4]));let r=new zi(t,Ne);s.setAttribute("a",new xn(r,2,0)),s.setAttribute("b",new xn(r,2,Ne)),s.setAttribute("meta",new xn(r,4,Ne+2)),s.instanceCount=Math.max(t.length/Ne-1,0);let o=new Ee(s,this.material);return o.frustumCulled=!1,o.userData.first=e,o.userData.end=e+t.length/Ne,o.onBeforeRender=()=>{this.material.uniforms.firstRecord.value=e,this.material.uniformsNeedUpdate=!0},o}refresh(t,e){if(!this.beads)return;let[n,s]=[this.beads.first[t],this.beads.first[e+1]];for(let r of this.chunks.children)r.userData.first<s&&r.userData.end>n&&(r.userData.hasCome=!0,r.geometry.getAttribute("a").data.needsUpdate=!0);this.setRange(this.shown)}setRange(t){this.shown=t;let e=this.beads;if(!e)return;let n=e.first[t.low],s=e.first[t.high],r=t.low===t.high?s+t.from:n,o=s+t.to;this.material.uniforms.range.value.set(r,o),sa(this.window);let a=o-n<t0;a&&this.window.add(this.chunk(e.words.slice(Ne*n,Ne*(o+1)),n,!1));for(let l of this.chunks.children){let c=l.userData.hasCome===!0||l.userData.first<e.first[e.taken];l.visible=c&&!a&&l.userData.first<=o&&l.userData.end>n}this.draw()}setColour(t,e){this.compile(Xd(t)),this.material.uniforms.scale.value.set(...e),this.draw()}compile(t){this.material.defines.BY!==t&&(this.material.defines.BY=t,this.material.needsUpdate=!0)}setShown(t,e){this.classShown[t]=e?1:0,this.draw()}isShown(t){return this.classShown[t]>0}get box(){if(this.part&&this.isPartShown)return[this.part.low.clone(),this.part.high.clone()];let t=this.beads?.index.part_mm??[[0,0,0],[100,100,10]];return[new C(...t[0]),new C(...t[1])]}drawPlate(){if(sa(this.plate),!this.beads&&!this.part)return;let[t,e]=this.box,n=Math.max(e.x-t.x,e.y-t.y,10),s=n>400?50:n>80?10:n>20?5:1,r=2*s,o=u=>Math.floor((u-r)/s)*s,a=u=>Math.ceil((u+r)/s)*s,l=[];for(let u=o(t.x);u<=a(e.x);u+=s)l.push(u,o(t.y),0,u,a(e.y),0);for(let u=o(t.y);u<=a(e.y);u+=s)l.push(o(t.x),u,0,a(e.x),u,0);let c=new Me;c.setAttribute("position",new Ht(new Float32Array(l),3));let h=new as(c,new Ni({color:9082526,transparent:!0,opacity:.45}));h.position.z=Math.min(0,t.z)-.02,this.plate.add(h)}view(t){let[e,n]=this.box,s=e.clone().add(n).multiplyScalar(.5),r=n.clone().sub(e),o={top:new C(0,-1e-4,1),front:new C(0,-1,0),side:new C(1,0,0),oblique:new C(-.55,-1.05,.95)},a=(o[t]??o.oblique).clone().normalize(),l=new C().crossVectors(new C(0,0,1),a);l.length()<.001&&l.set(1,0,0),l.normalize();let c=new C().crossVectors(a,l),h=p=>.5*(Math.abs(p.x)*r.x+Math.abs(p.y)*r.y+Math.abs(p.z)*r.z),u=Math.tan(this.camera.fov*Math.PI/360),d=Math.max(h(c),h(l)/Math.max(this.camera.aspect,.1))/u+h(a),f=1.25*Math.max(d,2);this.controls.target.copy(s),this.camera.position.copy(s).addScaledVector(a,f),this.camera.near=f/200,this.camera.far=f*20,this.camera.updateProjectionMatrix(),this.controls.update(),this.fitted=t,this.draw()}turn(t,e){let{target:n}=this.controls,s=this.camera.position.clone().sub(n),r=Math.atan2(s.y,s.x)+t*Math.PI/180,o=Math.acos(s.z/s.length())-e*Math.PI/180,a=Math.min(Math.max(o,.001),Math.PI-.001),l=new C(Math.sin(a)*Math.cos(r),Math.sin(a)*Math.sin(r),Math.cos(a));this.camera.position.copy(n).addScaledVector(l,s.length()),this.moved()}zoom(t){let{target:e}=this.controls;this.camera.position.sub(e).multiplyScalar(t).add(e),this.moved()}pan(t,e){let{target:n}=this.controls,s=2*this.camera.position.distanceTo(n)*Math.tan(this.camera.fov*Math.PI/360);this.camera.updateMatrixWorld();let r=a=>new C().setFromMatrixColumn(this.camera.matrixWorld,a),o=r(0).multiplyScalar(t*s).addScaledVector(r(1),e*s);this.camera.position.add(o),n.add(o),this.moved()}moved(){this.controls.update(),this.fitted=null,this.draw()}lookAt(t,e){let[n,s]=this.box,r=n.clone().add(s).multiplyScalar(.5),o=t.clone().sub(r);o.length()<1e-6&&o.set(-.55,-1.05,.95),o.normalize().add(new C(0,-.05,.2)).normalize();let a=1.25*e/Math.tan(this.camera.fov*Math.PI/360);this.controls.target.copy(t),this.camera.position.copy(t).addScaledVector(o,a),this.camera.near=a/200,this.camera.far=a*20+20*s.distanceTo(n),this.camera.updateProjectionMatrix(),this.controls.update(),this.fitted=null,this.draw()}project(t,e,n){this.camera.updateMatrixWorld();let s=new C(t,e,n).project(this.camera),r=this.canvas.getBoundingClientRect();return[r.left+(.5+.5*s.x)*r.width,r.top+(.5-.5*s.y)*r.height]}ray(t){let e=this.canvas.getBoundingClientRect(),n=new St((t.clientX-e.left)/e.width*2-1,1-(t.clientY-e.top)/e.height*2),s=new Co;return this.camera.updateMatrixWorld(),s.setFromCamera(n,this.camera),s}move(t){if(t.buttons!==0)return;let e=this.pointer!==null;this.pointer={x:t.clientX,y:t.clientY},!e&&requestAnimationFrame(()=>{let n=this.pointer;this.pointer=null,n&&(this.isPartShown?this.hoverPart(n.x,n.y):this.hover(this.beadAt(n.x,n.y)))})}beadAt(t,e){let n=this.beads;if(!n)return-1;let{origin:s,direction:r}=this.ray({clientX:t,clientY:e}).ray,{low:o,high:a}=this.shown,[l,c]=[this.material.uniforms.range.value.x,this.material.uniforms.range.value.y];if(c-l>kM||Math.abs(r.z)<1e-6)return-1;let h=r.z<0;for(let u=0;u<=a-o;u++){let d=h?a-u:o+u,f=(n.index.layers[d].z_mm-s.z)/r.z;if(f<=0)continue;let p=n.under(d,s.x+f*r.x,s.y+f*r.y,l,c,_=>this.isShown(_));if(p>=0)return p}return-1}setGesture(t){this.gesture=t,this.controls.enabled=t==="turn"||t==="split",this.canvas.style.cursor=t==="turn"?"":"crosshair"}get dragging(){return this.gesture}dragFaces(){let t=document.createElement("div");t.id="rubber",t.hidden=!0,this.canvas.after(t);let[e,n]=[null,null],s=o=>({left:Math.min(e.clientX,o.clientX),top:Math.min(e.clientY,o.clientY),right:Math.max(e.clientX,o.clientX),bottom:Math.max(e.clientY,o.clientY)});this.canvas.addEventListener("pointerdown",o=>{this.gesture==="turn"||this.gesture==="split"||!this.isPartShown||o.button!==0||(e=n=o,this.canvas.setPointerCapture(o.pointerId),this.gesture==="paint"&&this.onPaint(this.trianglesAt(o.clientX,o.clientY)))}),this.canvas.addEventListener("pointermove",o=>{if(!(!e||!n||!this.part)){if(this.gesture==="box"){let{left:a,top:l,right:c,bottom:h}=s(o),u=this.canvas.getBoundingClientRect();t.hidden=!1,Object.assign(t.style,{left:`${a-u.left}px`,top:`${l-u.top}px`,width:`${c-a}px`,height:`${h-l}px`})}else{let a=Math.ceil(Math.hypot(o.clientX-n.clientX,o.clientY-n.clientY)/HM),l=new Set,c=this.gesture==="paint";for(let h=0;h<=a;h++){let[u,d]=[n.clientX+(o.clientX-n.clientX)*h/Math.max(a,1),n.clientY+(o.clientY-n.clientY)*h/Math.max(a,1)];for(let f of c?this.trianglesAt(u,d):[this.part.faceAt(this.rayAt(u,d))])l.add(f)}l.delete(-1),c?this.onPaint([...l]):this.onPickFaces([...l])}n=o}});let r=o=>{if(e&&this.part&&!t.hidden&&o.type==="pointerup"){let{left:a,top:l,right:c,bottom:h}=s(o),u=this.canvas.getBoundingClientRect(),d=p=>2*(p-u.left)/u.width-1,f=p=>1-2*(p-u.top)/u.height;this.camera.updateMatrixWorld(),this.onPickFaces(this.part.facesIn(new Pt().multiplyMatrices(this.camera.projectionMatrix,this.camera.matrixWorldInverse),[d(a),f(h),d(c),f(l)]))}e&&this.gesture==="paint"&&this.onPaintEnd(),t.hidden=!0,e=n=null};this.canvas.addEventListener("pointerup",r),this.canvas.addEventListener("pointercancel",r)}trianglesAt(t,e){let s=[[0,0],...Array.from({length:8},(r,o)=>[i0*Math.cos(o*Math.PI/4),i0*Math.sin(o*Math.PI/4)])].map(([r,o])=>this.part?.search.first(this.rayAt(t+r,e+o))?.triangle??-1);return[...new Set(s)].filter(r=>r>=0)}hoverPart(t,e){let n=performance.now(),s=this.part?.faceAt(this.rayAt(t,e))??-1;this.setHovered(s),this.onFace(s,{clientX:t,clientY:e}),performance.measure("hover",{start:n})}setHovered(t){!this.part||this.part.hovered===t||(this.part.hovered=t,this.draw())}hover(t){this.material.uniforms.hovered.value!==t&&(this.material.uniforms.hovered.value=t,this.onHover(t>=0&&this.beads?this.beads.bead(t):null),this.draw())}pick(t){if(this.part&&this.isPartShown){if(this.gesture==="paint")return;if(this.gesture==="split"){this.onSplit(t);return}this.onPickFace(this.part.faceAt(this.ray(t).ray),t.shiftKey||this.gesture!=="turn");return}if(!this.picking||!this.beads)return;let{origin:e,direction:n}=this.ray(t).ray,[s,r]=this.box,o=null;for(let h of["x","y","z"]){if(Math.abs(n[h])<1e-9)continue;let u=n[h]>0,d=((u?s:r)[h]-e[h])/n[h];(!o||d>o[0])&&(o=[d,`${h}${u?"-":"+"}`])}if(!o)return;let a=e.clone().addScaledVector(n,o[0]),l=.05*r.distanceTo(s);["x","y","z"].every(h=>a[h]>s[h]-l&&a[h]<r[h]+l)&&this.onPick(o[1])}slab(t,e){let[n,s]=this.box;return Yd([n.toArray(),s.toArray()],t,e)}setPlaces(t){sa(this.places);let[e,n]=this.box,s=.22*n.distanceTo(e);for(let{side:r,depth_mm:o,colour:a,arrow:l}of t){let[c,h]=this.slab(r,o),u=[0,1,2].map(m=>Math.max(h[m]-c[m],.05)+.6),d=new Ui(...u),f=new C(...[0,1,2].map(m=>.5*(c[m]+h[m]))),p=new Ee(d,new Is({color:a,transparent:!0,opacity:.34,depthWrite:!1})),_=new as(new Ao(d),new Ni({color:a}));p.position.copy(f),_.position.copy(f),this.places.add(p,_),l&&this.places.add($M(f,new C(...l),s,a))}this.draw()}setCrack(t){sa(this.broken);let e=this.material.uniforms;if(e.breaks.value?.dispose(),e.breaks.value=null,t&&t.cells.length>0){let{cells:n,order:s,size_mm:r,angle_rad:o}=t,a=new ki,l=new Ui(...r);l.rotateZ(o),a.index=l.index,a.setAttribute("position",l.getAttribute("position")),a.setAttribute("normal",l.getAttribute("normal"));let c=new zi(n,Gs);a.setAttribute("cell",new xn(c,4,0)),a.setAttribute("broke",new xn(c,1,4)),a.setAttribute("order",new vo(s,1)),a.instanceCount=n.length/Gs;let h=new Ie({glslVersion:Cn,transparent:!0,depthTest:!1,uniforms:{state:e.state,colours:e.colours,byOrder:{value:!1}},vertexShader:`in vec4 cell; in float broke; in float order; uniform float state; out float lost; out float rank; out float shade;
void main() { lost = cell.w; rank = order; shade = 0.8 + 0.2 * normal.z + 0.1 * normal.x; gl_Position = broke > state ? vec4(2.0, 2.0, 2.0, 0.0) : projectionMatrix * viewMatrix * vec4(cell.xyz + position, 1.0); }`,fragmentShader:`in float lost; in float rank; in float shade; out vec4 result; uniform sampler2D colours; uniform bool byOrder;
void main() { result = byOrder ? vec4(texture(colours, vec2(clamp(rank, 0.002, 0.998), 0.5)).rgb * shade, 0.85) : vec4(mix(vec3(0.98, 0.72, 0.18), vec3(0.80, 0.05, 0.06), lost) * shade, 0.35 + 0.5 * lost); }`}),u=new Ee(a,h);u.frustumCulled=!1,u.renderOrder=2,this.broken.add(u);let d=new Pt().makeRotationZ(-o),[f,p]=[new C(1/0,1/0,1/0),new C(-1/0,-1/0,-1/0)],_=M=>new C().fromArray(n,Gs*M).applyMatrix4(d);for(let M=0;M<s.length;M++)f.min(_(M)),p.max(_(M));let m=new C(...r),g=p.sub(f).divide(m).round().addScalar(1),y=new Float32Array(2*g.x*g.y*g.z);for(let M=0;M<s.length;M++){let A=_(M).sub(f).divide(m).round();y.set([n[Gs*M+4]+1,s[M]],2*(A.x+g.x*(A.y+g.y*A.z)))}let b=new _r(y,g.x,g.y,g.z);b.format=_i,b.type=Rn,b.unpackAlignment=1,b.minFilter=b.magFilter=ye,b.needsUpdate=!0,e.breaks.value=b;let v=g.multiply(m);e.breaksFrom.value.makeScale(1/v.x,1/v.y,1/v.z).multiply(new Pt().makeTranslation(f.addScaledVector(m,-.5).negate())).multiply(d)}this.showCrack(null,0)}showCrack(t,e){let n=this.material.uniforms;n.state.value=e;let s=this.broken.children[0];s&&(s.visible=t==="lost"||t==="order",s.material.uniforms.byOrder.value=t==="order"),n.ghost.value=t==="lost"||t==="order"?.82:0,t==="beads"&&n.breaks.value&&this.compile(o0),this.draw()}};function $M(i,t,e,n){let s=new ze,r=new Is({color:n,depthTest:!1,transparent:!0}),o=new Ee(new Oi(e*.03,e*.03,e*.75),r),a=new Ee(new Bi(e*.09,e*.25,20),r);return o.position.y=e*.375,a.position.y=e*.875,s.add(o,a),s.position.copy(i),s.quaternion.copy(new Oe().setFromUnitVectors(new C(0,1,0),t.clone().normalize())),s.renderOrder=3,s.children.forEach(l=>l.renderOrder=3),s}function sa(i){i.traverse(t=>{let e=t;e.geometry?.dispose(),e.material&&!Array.isArray(e.material)&&!("firstRecord"in(e.material.uniforms??{}))&&e.material.dispose()}),i.clear()}function s0(i,t,e,n){let s=new mi(i,t,e,n,Rn);return s.minFilter=s.magFilter=ye,s.needsUpdate=!0,s}function r0(i){let t=new mi(ya(i),256,1,sn);return t.minFilter=t.magFilter=ye,t.needsUpdate=!0,t}var XM=[["x-","left end (low x)"],["x+","right end (high x)"],["y-","front (low y)"],["y+","back (high y)"],["z-","bottom"],["z+","top"]],qM=[["away","pull away"],["towards","push towards"],["down","down (−z)"],["up","up (+z)"],["x","+x"],["-x","−x"],["y","+y"],["-y","−y"]],YM=[["lost","what broke, by the stiffness lost"],["order","what broke, by the order of breaking"],["beads","the beads, by the order of breaking"],["none","nothing of it"]],ZM=2782386,JM=14048544,xh=class{constructor(t,e){this.panel=t;this.parts=e;this.empty("Open a G-code file to find where and at which load it breaks.")}panel;parts;program=null;hold="x-";load="x+";depth=0;direction="away";force=100;material="pla";profiles=[];mode=null;isActive=!1;crack=null;built=Promise.resolve();empty(t){this.panel.replaceChildren(S("p",{class:"note"},t))}setActive(t){this.isActive=t,this.draw()}forJob(){this.program=this.crack=null;let t=S("button",{type:"button",class:"main",id:"test-job",onclick:()=>{this.testJob()}},"Test the job's part");this.panel.replaceChildren(S("p",{class:"note"},"The part is planned, and its G-code is loaded in steps until it breaks. Where it is held and loaded is said in the tab Loads."),t,S("div",{id:"answer"}))}async testJob(){let t=this.parts.job();t&&await this.test({kind:"strength",...t,..."name"in t?{name:`${String(t.name)}-strength`}:{}})}forProgram(t){return this.built=this.begin(t)}async begin(t){this.program=t,this.crack=null;let e=this.parts.printed();if(!e){this.empty("Nothing is printed in this program, so nothing can be tested.");return}let n=[0,1,2].map(r=>e[1][r]-e[0][r]),s=["x","y","z"][n.indexOf(Math.max(...n))];[this.hold,this.load]=[`${s}-`,`${s}+`],this.depth=Number(nt(Math.max(.1*Math.max(...n),1),1));try{this.profiles=(await da()).profiles}catch(r){this.parts.say(r.message,!0)}this.build(),this.draw()}build(){let t=l=>{let c=S("select",{id:`${l}-side`,onchange:()=>{this[l]=c.value,this.draw()}},...XM.map(([u,d])=>S("option",{value:u,selected:u===this[l]},d))),h=S("button",{type:"button",id:`${l}-pick`,"aria-pressed":"false",onclick:()=>this.setMode(this.mode===l?null:l)},"Pick in the view");return h.hidden=!this.parts.viewer(),S("div",{class:"row"},S("label",{},l==="hold"?"Held at":"Loaded at",c),h)},e=(l,c,h,u)=>S("label",{},c,An({id:l,value:h},{isPositive:!0,isLive:!0},d=>{u(d),this.draw()})),n=S("select",{onchange:()=>{this.direction=n.value,this.draw()}},...qM.map(([l,c])=>S("option",{value:l,selected:l===this.direction},c))),s=this.profiles.filter(l=>l.kind==="material"),r=S("p",{class:"note"}),o=()=>{let c=(s.find(u=>u.name===this.material)?.toml??"").match(/strength_tier\s*=\s*"([^"]*)"/)?.[1],h={T0:"data sheets and literature",T1:"tests of coupons printed on this machine",T2:"T1, and confirmed by the test of a whole part"};r.textContent=c?`Card tier ${c}${h[c]?`: ${h[c]}`:""}`:"This material has no strengths."},a=S("select",{onchange:()=>{this.material=a.value,o(),this.draw()}},...s.map(l=>S("option",{value:l.name,selected:l.name===this.material,title:l.about},l.name)));o(),this.panel.replaceChildren(S("h2",{},"Material"),S("div",{class:"row"},S("label",{},"card",a)),r,S("h2",{},"Places"),t("hold"),t("load"),S("div",{class:"row"},e("depth","Depth of both, mm",this.depth,l=>this.depth=l)),S("h2",{},"Load"),S("div",{class:"row"},S("label",{},"direction",n),e("force","force, N",this.force,l=>this.force=l)),S("p",{class:"note"},"The force is scaled up until the part breaks; its size matters for nothing but the reserve."),S("div",{class:"row"},S("button",{type:"button",class:"main",id:"break",onclick:()=>{this.program&&this.test({kind:"strength",text:this.job(),name:"strength",program:this.program})}},"Break it")),S("details",{},S("summary",{},"The job file that is run"),S("pre",{id:"strength-job"})),S("div",{id:"answer"}))}setMode(t){this.mode=t;for(let n of["hold","load"])document.getElementById(`${n}-pick`)?.setAttribute("aria-pressed",String(t===n));let e=this.parts.viewer();e&&(e.picking=t!==null),t&&this.parts.say(`Click the side of the part where it is ${t==="hold"?"held":"loaded"}.`)}pick(t){if(!this.mode)return;this[this.mode]=t;let e=document.getElementById(`${this.mode}-side`);e&&(e.value=t),document.getElementById("progress").hidden=!0,this.setMode(null),this.draw()}get vector(){let t="xyz".indexOf(this.load[0]),e=this.load[1]==="+"?1:-1;return{down:[0,0,-1],up:[0,0,1],x:[1,0,0],"-x":[-1,0,0],y:[0,1,0],"-y":[0,-1,0]}[this.direction]??[0,1,2].map(s=>s===t?this.direction==="away"?e:-e:0)}job(){let t=this.parts.printed();if(!t)return"";let e=t[0][2]??0,n=r=>{let[o,a]=Yd(t,r,this.depth),l=(c,h)=>`[${c.map((u,d)=>nt(u+h-(d===2?e:0),3)).join(", ")}]`;return`{ box_mm = [${l(o,-.05)}, ${l(a,.05)}] }`},s=this.vector.map(r=>r*this.force);return`format = 1

[material]
profile = ${Fe(this.material)}

[strength]
enabled = true

[[guide.fixture]]
on = ${n(this.hold)}
fix = "xyz"

[[guide.load]]
on = ${n(this.load)}
force_n = [${s.join(", ")}]
`}draw(){let t=document.getElementById("strength-job");t&&(t.textContent=this.job());let e=this.parts.viewer();if(!e?.beads)return;let n=this.isActive&&this.program?[{side:this.hold,depth_mm:this.depth,colour:ZM},{side:this.load,depth_mm:this.depth,colour:JM,arrow:this.vector}]:[];e.setPlaces(n),this.isActive?this.crack?.():(this.setMode(null),e.showCrack(null,0))}async test(t){if(this.program&&this.hold===this.load){this.parts.say("The part is held and loaded at the same place; choose another side for one of them.",!0);return}let e=await this.parts.run(t);e&&await this.show(e.id)}async reopen(t,e){await this.built,await this.show(t),this.program&&document.getElementById("answer")?.prepend(S("p",{class:"note"},`What follows is of ${e}, with the places and the load of its own job file.`))}async show(t){try{let e=await In(t),n=e.damage?new Float32Array(await cn(`v1/jobs/${t}/damage`)):null;this.program||await this.parts.show(t),this.tell(e,n)}catch(e){this.parts.say(e.message,!0)}}tell(t,e){let n=t.report.strength,s=document.getElementById("answer");if(!n||!s)return;let{made:r,mark:o}=Jg(n,t.damage?.states??[]),a=t.damage&&e?this.replay(t.damage,e,o):[],l=(h,u)=>S("tr",{},S("td",{},h),S("td",{class:"n"},u)),c=Object.entries(n.modes).sort((h,u)=>u[1]-h[1]).map(([h,u])=>l(h,`${nt(100*u,0)} %`));s.replaceChildren(S("h2",{},"It breaks at"),S("p",{class:"big",id:"peak"},`${nt(n.peak_load_n,0)} N`),S("p",{class:"note"},`between ${nt(n.low_n,0)} and ${nt(n.high_n,0)} N over the card of the material (tier ${n.card_tier}) and the grid`),S("p",{id:"weakest"},`Weakest at ${n.weakest.words}.`),r,...a,S("table",{},l("First bead fails at",`${nt(n.first_n,0)} N`),l("Stiffness",`${nt(n.stiffness_n_per_mm,0)} N/mm`),l("Displacement at the peak",`${nt(n.peak_displacement_mm,3)} mm`),l("Mass of the part",`${nt(n.mass_g,2)} g`),l("Load over mass",`${nt(n.load_per_gram_n_g,0)} N/g`),l("Over the load given",`${nt(n.peak_load_n/n.job_load_n,2)} ×`),l("Model",`${n.fidelity}, cells of ${n.cell_mm} mm`)),S("h2",{},"How it fails"),S("table",{},...c),...t.warnings.map(Yn),S("div",{class:"row"},S("button",{type:"button",id:"compare",onclick:()=>this.parts.compare()},"Compare with another run")),S("details",{},S("summary",{},"Where the strengths come from"),S("p",{class:"note"},n.card_source))),this.crack?.(),s.scrollIntoView({block:"nearest"})}replay(t,e,n){let s=this.parts.viewer(),{states:r}=t,o=Array.from({length:e.length/Gs},(p,_)=>e[Gs*_+4]),a=[...new Set(o)].sort((p,_)=>p-_),l=Float32Array.from(o,p=>a.length>1?a.indexOf(p)/(a.length-1):1);s?.setCrack({cells:e,order:l,size_mm:t.cell_mm,angle_rad:t.angle_rad});let c=Math.max(r.length-1,0),h=S("select",{id:"crack-by",onchange:()=>this.crack?.()},...YM.map(([p,_])=>S("option",{value:p},_))),u=S("input",{id:"crack-step",type:"range",min:0,max:c,value:c,"aria-label":"Step of the load",oninput:()=>this.crack?.()}),d=S("output",{id:"crack-words",class:"note"}),f=S("button",{type:"button",id:"crack-play"});return f.addEventListener("click",ba(f,u,6,"Play how it breaks",()=>"0",()=>this.crack?.())),this.crack=()=>{let p=Number(u.value),[_,m]=r[p]??[0,0];if(n(_,m),d.textContent=`step ${p+1} of ${c+1}: ${nt(m,0)} N at ${nt(_,3)} mm, ${o.filter(y=>y<=p).length} of ${o.length} elements broken`,u.setAttribute("aria-valuetext",d.textContent),!s||!this.isActive)return;let g=h.value;if(this.parts.recolour(),s.showCrack(g==="none"?null:g,p),g==="order"||g==="beads"){let y=S("div",{class:"ramp"});y.style.background=Ki(Ln),Tt("legend").replaceChildren(S("div",{},"Order of breaking"),y,S("div",{class:"ends"},S("span",{},"first"),S("span",{},"last")))}},[S("div",{class:"row"},f,u),d,S("div",{class:"row"},S("label",{},"Show",h))]}};var ra=[["open","Open a file: G-code of any slicer, a mesh, a drawing, a photograph, a scan or a job. Dropping it on the page does as well."],["tab-loads","Loads: click the faces of a mesh where it is held and where it is loaded, and see the stress before anything is planned."],["tab-job","Job: printer, material and every setting, beside the text that the command line runs too. Plan the paths from here."],["tab-paths","Paths: every bead by layer and by move, coloured by role, speed, width and more. The pointer tells its numbers."],["tab-strength","Strength: at which load and where the part breaks, with a replay of the crack. Runs, above, sets two of them side by side. The key ? lists all keys."]],vh=class{constructor(t){this.box=t;t.addEventListener("keydown",e=>{e.key==="Escape"&&(this.go(-1),e.stopPropagation())})}box;at=-1;first(){try{localStorage.getItem("toured")||this.go(0)}catch{}}go(t){Tt(ra[Math.max(this.at,0)][0]).classList.remove("lit");let e=this.at>=0;if(this.at=t<ra.length?t:-1,this.box.hidden=this.at<0,this.at<0){try{localStorage.setItem("toured","yes")}catch{}e&&Tt("view").focus();return}let[n,s]=ra[this.at];Tt(n).classList.add("lit");let r=this.at===ra.length-1,o=S("button",{type:"button",class:"main",id:"tour-next",onclick:()=>this.go(this.at+1)},r?"Done":"Next");this.box.replaceChildren(S("p",{id:"tour-words","aria-live":"polite"},S("b",{},`${this.at+1} of ${ra.length} · `),s),S("div",{class:"row"},o,this.at>0&&S("button",{type:"button",id:"tour-back",onclick:()=>this.go(this.at-1)},"Back"),!r&&S("button",{type:"button",id:"tour-skip",onclick:()=>this.go(-1)},"Skip the tour"))),e&&o.focus()}};var h0=65536,KM=Tt("view"),Xr=Tt("welcome"),Ot=null,Zd=null,Sh=null,vs=0,Jd=0,Xi="role",Si=null,u0=[],Qd="",on=Tt("high"),Mn=Tt("low"),$i=Tt("from"),jn=Tt("to"),Vn=new Pa(Tt("panel-job"),{run:Yr,say:xe,renamed:i=>p0(i,"job")}),qr=new xh(Tt("panel-strength"),{run:Yr,say:xe,viewer:()=>Ot,printed:()=>Zd,job:()=>Vn.wanted(),showPaths:()=>ui("paths"),show:i=>Ws(i),recolour:()=>aa(Xi),compare:()=>{wh(2)}}),Re=new ia(Tt("panel-shape"),{run:Yr,say:xe,viewer:()=>Ot,job:Vn,openLoads:()=>ui("loads"),turning:()=>Gn.turning()}),Gn=new ph(Tt("panel-loads"),{run:Yr,say:xe,viewer:()=>Ot,job:Vn,shape:Re,test:()=>{ui("strength"),qr.testJob()}});Vn.onText=i=>{i!==null&&(Re.textChanged(i),Gn.textChanged(),Gn.chosenChanged(),Re.showPoses(Gn.inFile()))};Re.onPart=()=>{Gn.partChanged(),Re.showPoses(Gn.inFile()),tf()};Re.onChosen=()=>{Re.chosenChanged(),Gn.chosenChanged()};function xe(i,t=!1){let e=Tt("progress");e.replaceChildren(S("span",t?{class:"error",role:"alert"}:{},i),S("button",{type:"button",onclick:()=>e.hidden=!0},"Close")),e.hidden=!1}async function Yr(i,t){let e=i.kind==="view"||i.kind==="shape"?null:document.querySelector("[aria-invalid]");if(e)return xe(`Nothing was run: ${e.labels?.[0]?.firstChild?.textContent||e.id} is ${e.value||"empty"} and ${e.dataset.wrong}`,!0),null;try{return await d0(await wf(i),t)}catch(n){return xe(n.message,!0),null}}async function d0(i,t){let e=Tt("progress");try{let n=()=>{fa(i.id).catch(p=>xe(p.message,!0))};if(t?.aborted)return n(),null;t?.addEventListener("abort",n);let s=S("span"),r=S("progress",{"aria-label":"Progress"}),o=S("button",{type:"button",onclick:n},"Cancel");e.replaceChildren(s,r,o),e.hidden=!1;let a=Date.now(),l=setInterval(()=>d(),200),c=i,h=0,u=Promise.resolve(),d=()=>{let p=nt((Date.now()-a)/1e3,1);s.textContent=`${Nh(c)} · ${p} s`,c.total>0?(r.max=c.total,r.value=c.done):r.removeAttribute("value")};d();let f=await Af(i.id,p=>{c=p,d(),p.kind==="plan"&&p.phase==="running"&&p.ready>h&&$s!=="strength"&&(h===0||vs===p.id)&&(h=p.ready,u=Ws(p.id,!1).catch(_=>xe(_.message,!0)))}).finally(()=>{clearInterval(l),t?.removeEventListener("abort",n)});return s.isConnected&&(e.hidden=!0),t?.aborted?null:(f.phase==="failed"&&xe(f.error??"the run failed",!0),f.phase==="cancelled"&&xe("Cancelled. Nothing was changed."),f.phase==="done"&&await u,f.phase==="done"?f:null)}catch(n){return xe(n.message,!0),null}}function f0(){if(Ot)return Ot;try{Ot=new yh(KM)}catch{return xe("This browser shows no WebGL 2, so there is no view in three dimensions. Numbers and files are all here.",!0),null}return Ot.onHover=tw,Ot.onPick=i=>qr.pick(i),Ot.onFace=(i,t)=>QM(i,t),Ot.onPaint=i=>Re.supports.stroke(i),Ot.onSplit=i=>Gn.split(i),Ot.onPaintEnd=()=>Re.supports.strokeEnd(),Ot.onPickFaces=i=>Re.add(i),Ot.onPickFace=(i,t)=>Re.choose(i,t),Ot}function p0(i,t){Si={path:i,kind:t,name:i.split(/[/\\]/).pop()??i};let e=u0.find(n=>i.startsWith(`${n}/`)||i.startsWith(`${n}\\`));return Tt("title").textContent=e?i.slice(e.length+1):i,Tt("title").title=i,document.title=`${Si.name} – grainpath studio`,Si}async function Zr(i,t){let e=p0(i,t);Xr.hidden=!0;let n=Tt("progress");if(n.hidden=!0,t==="program"){Vn.close(),Re.close(),ui("paths");let s=await Yr({kind:"view",file:i});s&&await Ws(s.id)}else{f0(),Ot?.clear(),Re.close(),await Vn.open(e),qr.forJob();let s=Vn.text(),r=s!==null&&ia.has(s);ui(r?"shape":"job"),r&&await Re.load(),Vn.notice&&(n.hidden||!n.querySelector(".error"))&&xe(Vn.notice)}}function m0(i){let t=i.split(".").pop()?.toLowerCase()??"";return t==="toml"?"job":["stl","obj","ply","off","3mf","step","stp","iges","igs"].includes(t)?"mesh":["svg","dxf"].includes(t)?"outline":["png","jpg","jpeg","bmp"].includes(t)?"photo":["nrrd","nhdr","mhd","mha","nii","tif","tiff","dcm"].includes(t)||/\.nii\.gz$/i.test(i)?"scan":["gcode","gco","g","nc","ngc","tap","bgcode"].includes(t)?"program":"other"}async function g0(i){let t=i?.items[0],e=i?.files[0];if(t?.webkitGetAsEntry?.()?.isDirectory){xe("Folders are not sent through the browser. Press Open… and choose the folder on the server's side; --root DIR adds one.",!0);return}if(!e)return;let n=Tt("progress"),s=S("span");n.replaceChildren(s),n.hidden=!1;try{let{path:r}=await Ef(e,o=>s.textContent=`Sending ${e.name}: ${Math.round(100*o)} %`);n.hidden=!0,await Zr(r,m0(r))}catch(r){xe(r.message,!0)}}async function Ws(i,t=!0){let e=f0();Xr.hidden=!0,Sh?.abort();let n=Sh=new AbortController,s=vs===i&&Jd===i?Ot?.beads??null:null;vs=i;let[r,o]=await Promise.all([Mf(i),t?In(i):null]);if(vs!==i||n.signal.aborted)return;Zd=r.layers.length===0?null:r.part_mm;let a=s===null&&Si?.kind==="program";if(a&&qr.forProgram(Si.path),!Zd){xe("Nothing is printed in this program.",!0);return}let l=new xa(r);b0(r,o),tf();let c=r.layers.length-1,h=s===null||on.value===on.max;for(let f of[on,Mn])f.max=String(c);s===null&&(Mn.value="0"),h&&(on.value=String(c));let u=a&&!r.generator?.startsWith("grainpath")?"strength":"paths";if(!e){a&&ui(u);return}let d=s?l.keep(s):0;e.show(l,s!==null),Jd=i,s===null&&ui($s==="strength"?"strength":u),aa(Xi),Hs(),performance.mark("program");try{for(let f=d;f<=c;){let p=f;for(;f>0&&p<c&&p-f<4e3&&l.first[p+2]-l.first[f]<h0;)p++;if(l.take(f,p,await cn(`v1/jobs/${i}/layers/${f}-${p}`,n.signal)),n.signal.aborted)return;e.refresh(f,p),f===0&&performance.mark("first-layer"),f=p+1}if(y0(),r.more)return;performance.mark("all-layers"),document.documentElement.dataset.shown=String(i),o&&await _0(i,l,n.signal,o)}catch(f){n.signal.aborted||xe(f.message,!0)}}async function jM(i){let t=Ot?.beads;if(t?.index.more){await Ws(i);return}let e=await In(i);!t||vs!==i||(b0(t.index,e),Sh&&await _0(i,t,Sh.signal,e).catch(n=>xe(n.message,!0)))}async function _0(i,t,e,n){let s=t.index.layers.length-1;for(let r of["angles","reserve"].filter(o=>n[o])){for(let o=0;o<=s;){let a=o;for(;a<s&&a-o<4e3&&t.first[a+2]-t.first[o]<h0;)a++;let l=await cn(`v1/jobs/${i}/layers/${o}-${a}/${r}`,e);if(e.aborted||Ot?.beads!==t)return;t.takeValues(r,o,a,l),Ot.refresh(o,a),o=a+1}document.documentElement.dataset[r]=String(i)}}var bh=i=>Gf(Ot?.beads?.index,i);function y0(){let i=Ot?.beads;if(!i)return;let t=i.index.layers[Number(on.value)].records-1;for(let e of[$i,jn])e.max=String(t);[$i.value,jn.value]=["0",String(t)],oa()}function Hs(){Number(Mn.value)>Number(on.value)&&(document.activeElement===Mn?on.value=Mn.value:Mn.value=on.value),Tt("layer-high").textContent=bh(Number(on.value)),Tt("layer-low").textContent=bh(Number(Mn.value)),on.setAttribute("aria-valuetext",bh(Number(on.value)).replace(`
`," at ")),Mn.setAttribute("aria-valuetext",bh(Number(Mn.value)).replace(`
`," at ")),y0()}function oa(){Number($i.value)>Number(jn.value)&&(document.activeElement===$i?jn.value=$i.value:$i.value=jn.value),Tt("move").textContent=`${jn.value} of ${jn.max}`,Ot?.setRange({low:Number(Mn.value),high:Number(on.value),from:Number($i.value),to:Number(jn.value)})}var x0=ba(Tt("play"),jn,8,"Play the moves of the layer",()=>$i.value,oa);function aa(i){Xi=i;let t=Ot?.beads?.index;!t||!Ot||(Ot.setColour(i,Fh(t,i,Mh??1)),Tt("legend").replaceChildren(...zf(t,i,Mh??1)))}function QM(i,t){let e=Re.supports.wordsAt(t)??Gn.wordsAt(i,t),n=Tt("bead");n.hidden=e===null,n.textContent=e??""}function tf(){let i=Ot?.isPartShown??!1,t=!i&&!!Ot?.beads;for(let e of["layers","moves"])Tt(e).hidden=!t;Tt("views").hidden=!i&&!t,Tt("bead").hidden=!0,t?(Tt("legend").hidden=!1,aa(Xi)):$s!=="loads"&&(Tt("legend").hidden=!0)}function tw(i){let t=Tt("bead");t.hidden=i===null;let e=Ot?.beads?.index;!i||!e||(t.textContent=Vf(e,i))}var v0=!1,Mh=null,Kd=()=>Zi.filter(([i])=>(i!=="load"||v0)&&(i!=="reserve"||Mh!==null));function b0(i,t){v0=t?.angles??!1,Mh=t?.reserve?t.report.reserve?.first_failure?.[1]??null:null,Kd().some(([l])=>l===Xi)||(Xi="role");let e=S("select",{id:"colour-by",onchange:()=>aa(e.value)},...Kd().map(([l,c])=>S("option",{value:l,selected:l===Xi},c))),n=i.shares.map((l,c)=>{let h=c<qe,u=i.pulls[c-qe-2]??0;if(l.beads+u===0&&c!==qe)return null;let d=S("input",{type:"checkbox",id:`class-${c}`,checked:h||(Ot?.isShown(c)??!1),onchange:()=>Ot?.setShown(c,d.checked)});h&&Ot?.setShown(c,!0);let f=S("label",{for:`class-${c}`},qs(Ji[c]??ga[c-qe-2]),i.classes[c]);return S("tr",{},S("td",{},d),S("td",{},f),S("td",{class:"n"},u>0?String(u):h?`${nt(l.length_mm/1e3,1)} m`:""))}),[s,r]=i.part_mm,o=[0,1,2].map(l=>nt(r[l]-s[l],1)).join(" × "),a=(l,c)=>S("tr",{},S("td",{},l),S("td",{class:"n"},c));Tt("panel-paths").replaceChildren(S("h2",{},"Colour"),S("div",{class:"row"},S("label",{},"by",e)),S("h2",{},"Show"),S("table",{},...n),S("h2",{},"Program"),S("table",{},a("Written by",i.generator??"not stated"),a("Part",`${o} mm`),a("Layers",`${i.layers.length}${i.more?" so far":""}`),a("Beads",String(i.shares.reduce((l,c)=>l+c.beads,0))),a("Time, estimated",ji(i.time_s)),a("Filament",`${nt(i.filament_mm/1e3,2)} m`)),...t?[...ew(t),...t.warnings.map(Yn)]:[S("p",{class:"note"},"Files and warnings follow once the paths are measured.")],...Si?.kind==="program"?[S("p",{},S("button",{type:"button",class:"main",onclick:()=>ui("strength")},"Where does it break?"))]:[])}function ew(i){if(i.outputs.length===0)return[];let t=e=>S("li",{},S("a",{href:`v1/jobs/${vs}/outputs/${e.kind}`,download:e.path.split("/").pop()??""},`${e.kind}: ${e.path.split("/").pop()}`));return[S("h2",{},"Files"),S("ul",{class:"plain"},...i.outputs.map(t))]}var $r=["shape","loads","job","paths","strength"],$s="paths";function ui(i){$s=i,i==="shape"||i==="loads"||!Ot?.beads?Ot?.setMode("part"):i!=="job"&&Ot?.setMode("paths");for(let t of $r){let e=Tt(`tab-${t}`);e.setAttribute("aria-selected",String(t===i)),e.tabIndex=t===i?0:-1,Tt(`panel-${t}`).hidden=t!==i}tf(),Re.supports.setActive(i==="shape"),qr.setActive(i==="strength"),Gn.setActive(i==="loads"),Vn.setActive(i==="job")}for(let i of $r)Tt(`tab-${i}`).addEventListener("click",()=>ui(i)),Tt(`tab-${i}`).addEventListener("keydown",t=>{let e=t.key==="ArrowRight"?1:t.key==="ArrowLeft"?-1:0;if(e===0)return;let n=$r[($r.indexOf(i)+e+$r.length)%$r.length];ui(n),Tt(`tab-${n}`).focus()});function Wr(i,t,e){i.value=String(Number(i.value)+t),e()}document.addEventListener("keydown",i=>{let t=i.target,e=["INPUT","TEXTAREA"].includes(t.tagName)&&!(t instanceof HTMLInputElement&&["checkbox","range"].includes(t.type));if((i.ctrlKey||i.metaKey)&&i.key.toLowerCase()==="z"&&!e&&Vn.text()!==null){i.shiftKey?Vn.redo():Vn.undo(),i.preventDefault();return}if(i.ctrlKey||i.metaKey||i.altKey||["INPUT","TEXTAREA","SELECT"].includes(t.tagName)||document.querySelector("dialog[open]"))return;let n=i.shiftKey?10:1,s=i.key.toLowerCase(),r=$s==="loads"&&!!Ot?.isPartShown;if(!(Ot&&Hf(Ot,i)))if(i.key==="Escape"&&Ot&&Ot.dragging!=="turn")Gn.setGesture("turn"),Re.supports.setPaint(null);else if(i.key==="Escape"&&Re.chosen.length>0)Re.choose(-1,!1);else if(r&&s in jd)i.repeat||Gn.setGesture(jd[s]);else if(r&&s==="g")Re.grow(!i.shiftKey);else{if(Ot?.isPartShown&&!["o","?","h"].includes(i.key))return;if(i.key==="ArrowUp")Wr(on,n,Hs);else if(i.key==="ArrowDown")Wr(on,-n,Hs);else if(i.key==="PageUp")Wr(Mn,n,Hs);else if(i.key==="PageDown")Wr(Mn,-n,Hs);else if(i.key==="ArrowRight"&&t.getAttribute("role")!=="tab")Wr(jn,n,oa);else if(i.key==="ArrowLeft"&&t.getAttribute("role")!=="tab")Wr(jn,-n,oa);else if(i.key==="l")Mn.value=Mn.value===on.value?"0":on.value,Hs();else if(i.key==="c"){let o=Kd(),a=o.findIndex(([c])=>c===Xi);aa(o[(a+1)%o.length][0]);let l=document.getElementById("colour-by");l&&(l.value=Xi)}else if(i.key==="t")document.getElementById(`class-${qe}`)?.click();else if(i.key==="o")ef();else if(i.key==="?")S0();else if(s==="h")wh();else if(i.key===" "&&t.tagName!=="BUTTON")x0();else return}i.preventDefault()});var jd={r:"box",b:"brush"};document.addEventListener("keyup",i=>{jd[i.key.toLowerCase()]===Ot?.dragging&&Gn.setGesture("turn")});function S0(){let i=[["o","open a file"],["1 2 3 4","look from the top, the front, the side, obliquely"],["A D W S","turn the view; with shift move it"],["+ -","nearer, and farther away"],["↑ ↓","highest layer; with shift ten at a time"],["PageUp PageDown","lowest layer"],["← →","moves of the highest layer"],["space","play the moves"],["l","one layer alone, and back"],["c","next way of colouring"],["t","travels"],["Ctrl+Z Ctrl+Shift+Z","undo and redo a change of the job"],["R B","hold and drag: choose the faces in a box, or all that are touched"],["G","neighbours over smooth edges too; with shift all neighbours"],["Esc","choose no face"],["h","runs, and two side by side"],["?","this page"]],t=Tt("keys");t.replaceChildren(S("h2",{},"Keys"),S("table",{},...i.map(([e,n])=>S("tr",{},S("td",{},...e.split(" ").map(s=>S("kbd",{},s))),S("td",{},n)))),S("h2",{},"Pointer"),S("p",{},"Drag turns, scroll zooms, drag with the right button moves. Rest on a bead for its numbers, on a face for its name, on a stress for its values. Click a face to choose it, with shift further ones."),S("p",{},S("button",{type:"button",id:"show-tour",onclick:()=>{t.close(),E0.go(0),Tt("tour-next").focus()}},"Show the tour")),S("p",{},S("a",{href:"licences.txt",target:"_blank"},"Licences of the page")),S("p",{},S("button",{type:"button",onclick:()=>t.close()},"Close"))),t.showModal()}function M0(i){document.documentElement.dataset.theme=i;try{localStorage.setItem("theme",i)}catch{}}async function ef(){let i=await If(Tt("chooser"),vs===0&&!Si?null:Si?.path??null);i&&await Zr(i.path,i.kind)}async function nw(i,t,e){try{let{text:n,folder:s}=await ua(i.input??`${Qd}/${i.name}/job.toml`),r=ge(Ca(n,s),"fill","mass_g",Vs(t)),o=await Yr({kind:"strength",text:r,name:`${i.name.replace(/-equal(-\d+)?$/,"")}-equal`});o&&await wh([e,o.title])}catch(n){xe(n.message,!0)}}async function w0(i){try{let t=(await Kr()).jobs.reverse().find(n=>n.title===i.name&&n.kind===i.kind&&n.phase==="done"),e=i.input??`${Qd}/${i.name}/job.toml`;await Zr(e,m0(e)),t?i.kind==="strength"?(ui("strength"),await qr.reopen(t.id,i.name)):($s="paths",await Ws(t.id)):xe(`The paths of ${i.name} are kept until the studio ends; this is the file it was made of. Run it again to see them.`)}catch(t){xe(t.message,!0)}}async function c0(){let i=(await Kr()).jobs.find(({kind:s,phase:r})=>(s==="plan"||s==="strength")&&(r==="waiting"||r==="running")),t=Si,e=i&&await d0(i),n=e&&(await jr()).runs.find(s=>s.name===e.title&&s.kind===e.kind);n&&Si===t&&await w0(n)}async function wh(i=0){try{await Bf(Tt("history"),i,(...t)=>{nw(...t)},t=>{w0(t)})}catch(t){xe(t.message,!0)}}var A0=null;try{A0=localStorage.getItem("theme")}catch{}M0(A0??(matchMedia("(prefers-color-scheme: dark)").matches?"dark":"light"));Tt("theme").addEventListener("click",()=>M0(document.documentElement.dataset.theme==="dark"?"light":"dark"));Tt("open").addEventListener("click",()=>{ef()});Tt("help").addEventListener("click",S0);Tt("runs").addEventListener("click",()=>{wh()});Tt("play").addEventListener("click",x0);for(let i of[on,Mn])i.addEventListener("input",Hs);for(let i of[$i,jn])i.addEventListener("input",oa);Tt("views").addEventListener("click",i=>{let t=i.target.dataset.view;t&&Ot?.view(t)});document.addEventListener("dragover",i=>{i.preventDefault(),Xr.classList.add("over")});document.addEventListener("dragleave",()=>Xr.classList.remove("over"));document.addEventListener("drop",i=>{i.preventDefault(),Xr.classList.remove("over"),g0(i.dataTransfer)});Tt("panel-paths").append(S("p",{class:"note"},"Open a G-code file of any slicer to see its paths, or a mesh, a drawing, a photograph, a scan or a job to plan them."));async function iw(i){try{await Zr((await vf(i)).path,"job")}catch(t){xe(t.message,!0)}}async function sw(){try{let i=await ha();if([u0,Qd]=[i.roots,i.work],i.opened){await Zr(i.opened.path,i.opened.kind),c0();return}let t=S("input",{type:"file",hidden:!0,onchange:()=>{if(t.files?.[0]){let e=new DataTransfer;e.items.add(t.files[0]),g0(e)}}});Xr.replaceChildren(S("div",{},S("h2",{},"Where does your print break?"),S("p",{},"Drop G-code of any slicer here: see its paths, pick where it is held and where it is loaded, and see at which load and where it breaks. Or drop a mesh (STL, OBJ, PLY, OFF, 3MF) or a job file: click the faces that hold and carry it, see its stress, plan it and test it. A photograph of a board and a scan are planned too."),S("div",{class:"row middle"},S("button",{type:"button",class:"main",onclick:()=>{ef()}},"Choose a file of this computer"),S("button",{type:"button",onclick:()=>t.click()},"Send one with the browser"),t),...await rw(),S("h3",{},"Or begin with an example"),S("ul",{class:"plain examples"},...(await xf()).examples.map(({name:e,about:n})=>S("li",{},S("button",{type:"button","data-example":e,onclick:()=>{iw(e)}},S("b",{},e),` ${n}`)))),S("p",{class:"note"},`Nothing leaves this computer. Results are written to ${i.work}.`))),c0()}catch(i){xe(i.message,!0)}}async function rw(){let i;try{i=await wa()}catch(e){return[S("p",{class:"error"},e.message)]}if(i.length===0)return[];let t=e=>{let n=S("li",{},S("button",{type:"button","data-draft":e.path,title:e.path,onclick:()=>{Zr(e.path,e.kind)}},S("b",{},e.path.split(/[/\\]/).pop()??e.path),` changed ${new Date(1e3*e.at_s).toLocaleString()}`),S("button",{type:"button",title:"Throw these changes away",onclick:()=>{Ma(e.path).then(()=>n.remove(),s=>xe(s.message,!0))}},"Discard"));return n};return[S("h3",{},"Or go on with changes that were not saved"),S("ul",{class:"plain examples"},...i.map(t))]}var E0=new vh(Tt("tour"));sw().then(()=>E0.first());Object.defineProperty(window,"studio",{get:()=>({viewer:Ot,show:Ws,part:Re.view,report:Re.report,chosen:Re.chosen,rendererName:Ot?.rendererName})});document.addEventListener("planned",i=>{let t=i.detail;if(Jd===t&&vs===t&&Ot?.beads){jM(t);return}$s="paths",Ws(t)});
